#include "experiments/report/report_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "core/image/image_io.h"
#include "experiments/report/chain_data.h"
#include "experiments/report/chain_maps.h"
#include "experiments/report/picture_code.h"
#include "experiments/report/replicate_maps.h"
#include "experiments/report/report.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

// Shares of kReportImageBytes for what is the same size whatever the film is.
constexpr double kTechniqueBytes = 4e6;
constexpr double kChainBytes = 4e6;
constexpr int kTechniqueEdge = 128;  ///< pixels, of the images of techniques
/// Share of the rest for maps, where not every pixel has room.
constexpr double kMapShare = 0.2;
constexpr int kPicturesOfCell = 3;  ///< mean, median and worst replicate

constexpr double base64Size(double bytes) {
    return bytes * 4 / 3;
}

/// The folders of a cell's replicates that left an image, by number.
std::map<std::size_t, fs::path> replicateFolders(const fs::path& cellFolder) {
    std::map<std::size_t, fs::path> folders;
    if (!fs::exists(cellFolder)) return folders;
    for (const fs::directory_entry& entry : fs::directory_iterator(cellFolder)) {
        const std::string name = entry.path().filename().string();
        std::size_t replicate = 0;
        const char* const end = name.data() + name.size();
        const bool numbered = name.starts_with('r') && std::from_chars(name.data() + 1, end, replicate).ptr == end;
        if (numbered && fs::exists(entry.path() / "image.exr")) folders.emplace(replicate, entry.path());
    }
    return folders;
}

/// The replicate the summary names, or else the one of this rank (0 … 1) in the primary metric, or else the first.
std::size_t chooseReplicate(const Json& cell, const char* name, double rank, const std::string& metric) {
    if (const auto named = cell.find(name); named != cell.end() && named->is_number_unsigned())
        return named->get<std::size_t>();
    const Json values = cell.value(Json::json_pointer("/metrics/" + metric + "/values"), Json::array());
    std::vector<std::pair<double, std::size_t>> sorted;
    for (std::size_t r = 0; r < values.size(); ++r)
        if (values[r].is_number()) sorted.emplace_back(values[r].get<double>(), r);
    if (sorted.empty()) return 0;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(rank * double(sorted.size() - 1))].second;
}

/// Elements of the page, numbered: texts of their own, so that the browser parses only what it shows.
class Elements {
public:
    std::size_t add(const Json& size, std::string_view bytes) {
        const std::size_t id = sizes.size();
        sizes.push_back(size);
        text += fmt::format("<script type=\"text/plain\" id=\"image-{}\">{}</script>\n", id, encodeBase64(bytes));
        return id;
    }
    std::size_t add(const Image& image) {
        return add({{"width", image.width}, {"height", image.height}}, encodeRgb9e5(image));
    }
    std::size_t addJpeg(const Image& image) {
        const JpegPicture picture = encodeJpegPicture(image);
        return add({{"width", image.width}, {"height", image.height}, {"toe", picture.toe}, {"step", picture.step}},
                   picture.bytes);
    }
    /// With how much wider and higher its blocks are than the image together.
    std::size_t add(const ByteMap& map, const Image& image) {
        const std::string_view bytes(reinterpret_cast<const char*>(map.bytes.data()), map.bytes.size());
        return add(
            {{"width", map.width},
             {"height", map.height},
             {"block", map.block},
             {"span", {double(map.width) * map.block / image.width, double(map.height) * map.block / image.height}}},
            bytes);
    }

    Json sizes = Json::array();
    std::string text;
};

/// What a cell shows, before its images are read.
struct CellPlan {
    std::string cell;
    std::map<std::size_t, fs::path> replicates;  ///< folders
    std::size_t median = 0, worst = 0;
    std::optional<fs::path> reference;
    std::vector<std::pair<int, int>> techniques;  ///< (s, t) with images in the median replicate's extra/
    Json result;                                  ///< the median replicate's result.json

    fs::path folder() const { return replicates.at(median); }
};

fs::path techniqueFile(const fs::path& replicate, std::pair<int, int> technique, std::string_view kind) {
    return replicate / "extra" / fmt::format("s{:02}_t{:02}_{}.exr", technique.first, technique.second, kind);
}

std::vector<std::pair<int, int>> techniquesIn(const fs::path& replicate) {
    std::vector<std::pair<int, int>> found;
    if (!fs::exists(replicate / "extra")) return found;
    for (const fs::directory_entry& entry : fs::directory_iterator(replicate / "extra")) {
        const std::string name = entry.path().filename().string();
        if (name.size() < 7 || name[0] != 's' || !name.ends_with("_weighted.exr")) continue;
        int s = 0, t = 0;
        const char* const end = name.data() + name.size();
        const auto read = std::from_chars(name.data() + 1, end, s);
        if (read.ec != std::errc() || end - read.ptr < 3 || std::from_chars(read.ptr + 2, end, t).ec != std::errc())
            continue;
        if (fs::exists(techniqueFile(replicate, {s, t}, "unweighted"))) found.emplace_back(s, t);
    }
    std::ranges::sort(found);
    return found;
}

CellPlan planCell(const fs::path& runDir, const Json& cell, const std::string& metric) {
    CellPlan plan;
    plan.cell = cell.at("cell").get<std::string>();
    plan.replicates = replicateFolders(runDir / "cells" / plan.cell);
    const auto there = [&](std::size_t replicate) {
        return plan.replicates.empty() || plan.replicates.contains(replicate) ? replicate
                                                                              : plan.replicates.begin()->first;
    };
    plan.median = there(chooseReplicate(cell, "median_replicate", 0.5, metric));
    plan.worst = there(chooseReplicate(cell, "worst_replicate", 1, metric));
    const std::string reference = cell.value("reference_image", std::string());
    if (!reference.empty() && fs::exists(runDir / reference)) plan.reference = runDir / reference;
    if (plan.replicates.empty()) return plan;
    plan.techniques = techniquesIn(plan.folder());
    plan.result = readJsonIfThere(plan.folder() / "result.json");
    return plan;
}

/// The film is the experiment's, so one image tells the size of all.
double pixelsOf(const std::vector<CellPlan>& plans) {
    for (const CellPlan& plan : plans)
        if (!plan.replicates.empty()) return double(readImage((plan.folder() / "image.exr").string()).pixels.size());
    return 0;
}

bool hasChains(const CellPlan& plan) {
    return plan.result.is_object() && plan.result.value("traces", Json()).is_object();
}

std::set<fs::path> referencesOf(const std::vector<CellPlan>& plans) {
    std::set<fs::path> references;
    for (const CellPlan& plan : plans)
        if (plan.reference) references.insert(*plan.reference);
    return references;
}

/// Bytes of base64 that the pictures of all cells take for a pixel of the film, as RGB9E5.
double exactPictureBytes(const std::vector<CellPlan>& plans) {
    const auto cells = std::ranges::count_if(plans, [](const CellPlan& plan) { return !plan.replicates.empty(); });
    return base64Size(4 * (kPicturesOfCell * double(cells) + double(referencesOf(plans).size())));
}

/// The same of their maps, of which each has a byte for a block.
double mapBytes(const std::vector<CellPlan>& plans) {
    double bytes = 0;
    for (const CellPlan& plan : plans) {
        if (!plan.replicates.empty()) bytes += plan.reference ? 2 : 1;
        if (hasChains(plan)) bytes += 1 + 1.0 / (kRhatBlock * kRhatBlock);
    }
    return base64Size(bytes);
}

/// The smallest factor by whose square the bytes must be divided to be at most `most`.
int shrinkFactor(double bytes, double most) {
    int factor = 1;
    while (bytes / (double(factor) * factor) > most) ++factor;
    return factor;
}

/// Whether the pictures of all cells, shrunk and as JPEG, fit; those of a cell are taken to be as long as its median
/// replicate's.
bool jpegsFit(const std::vector<CellPlan>& plans, int factor, double most) {
    std::set<fs::path> references;
    for (const CellPlan& plan : plans) {
        if (plan.replicates.empty()) continue;
        const Image image = shrink(readImage((plan.folder() / "image.exr").string()), factor);
        const bool withReference = plan.reference && references.insert(*plan.reference).second;
        most -= base64Size(double(encodeJpegPicture(image).bytes.size())) * (kPicturesOfCell + (withReference ? 1 : 0));
        if (most < 0) return false;
    }
    return true;
}

/// How much the images of the cells are shrunk.
struct Sizes {
    bool exact = true;           ///< RGB9E5, not JPEG
    int pictures = 1, maps = 1;  ///< edges of the blocks of pixels that became one
};

Sizes chooseSizes(const std::vector<CellPlan>& plans, double pixels, double most) {
    const double bytesOfMaps = pixels * mapBytes(plans);
    if (pixels * exactPictureBytes(plans) + bytesOfMaps <= most) return {};
    Sizes sizes{.exact = false, .pictures = 1, .maps = shrinkFactor(bytesOfMaps, kMapShare * most)};
    const double left = most - bytesOfMaps / (double(sizes.maps) * sizes.maps);
    while (sizes.pictures * sizes.pictures < pixels && !jpegsFit(plans, sizes.pictures, left)) ++sizes.pictures;
    return sizes;
}

class Gatherer {
public:
    Gatherer(std::vector<CellPlan> plans) : plans_(std::move(plans)) {}

    PagePictures gather() {
        const double pixels = pixelsOf(plans_);
        double techniques = 0, chains = 0, chainBytes = 0;
        for (const CellPlan& plan : plans_) {
            techniques += 2 * double(plan.techniques.size());
            if (!hasChains(plan)) continue;
            ++chains;
            const Json& traces = plan.result["traces"];
            chainBytes += base64Size(kDrawBytes * traces.at("chains").get<double>() * traces.at("draws").get<double>());
        }
        const double techniqueBytes = base64Size(4 * techniques * pixels);
        techniqueFactor_ = std::max(shrinkFactor(techniqueBytes, kTechniqueBytes),
                                    shrinkFactor(pixels, double(kTechniqueEdge) * kTechniqueEdge));
        if (chains > 0) chainShare_ = kChainBytes / chains;
        const double others =
            techniqueBytes / (double(techniqueFactor_) * techniqueFactor_) + std::min(chainBytes, kChainBytes);
        sizes_ = chooseSizes(plans_, pixels, kReportImageBytes - others);

        PagePictures page;
        page.cells = Json::object();
        for (const CellPlan& plan : plans_) page.cells[plan.cell] = embed(plan);
        page.sizes = std::move(elements_.sizes);
        page.elements = std::move(elements_.text);
        page.shrink = sizes_.pictures;
        page.exact = sizes_.exact;
        return page;
    }

private:
    std::size_t addFile(const fs::path& file) {
        const auto known = files_.find(file);
        if (known != files_.end()) return known->second;
        return files_[file] = addPicture(readImage(file.string()));
    }

    std::size_t addPicture(const Image& image) {
        const Image small = shrink(image, sizes_.pictures);
        return sizes_.exact ? elements_.add(small) : elements_.addJpeg(small);
    }

    Json embed(const CellPlan& plan) {
        Json ids = Json::object();
        if (plan.reference) ids["reference"] = addFile(*plan.reference);
        if (plan.replicates.empty()) return ids;
        embedMaps(plan, ids);
        for (const auto& [name, replicate] : {std::pair{"median", plan.median}, std::pair{"worst", plan.worst}}) {
            ids[name] = addFile(plan.replicates.at(replicate) / "image.exr");
            ids[fmt::format("{}_replicate", name)] = replicate;
        }
        embedTechniques(plan, ids);
        embedChains(plan, ids);
        return ids;
    }

    void embedMaps(const CellPlan& plan, Json& ids) {
        std::vector<fs::path> folders, files;
        for (const auto& [replicate, folder] : plan.replicates) folders.push_back(folder), files.push_back(folder / "image.exr");
        const ReplicateMaps maps = mapReplicates(files, referenceOf(plan), sizes_.maps);
        ids["mean"] = addPicture(maps.mean);
        if (files.size() > 1) ids["deviation"] = elements_.add(maps.deviation, maps.mean);
        if (maps.tests) ids["tests"] = elements_.add(*maps.tests, maps.mean);
        if (!hasChains(plan)) return;
        if (const auto rhat = mapRhat(folders, sizes_.maps)) ids["rhat"] = elements_.add(*rhat, maps.mean);
        if (const auto acceptance = mapAcceptance(folders, sizes_.maps))
            ids["acceptance"] = elements_.add(*acceptance, maps.mean);
    }

    /// Null where the variance of its pixels is not known. Cells that share a reference follow each other: one is kept.
    const MapReference* referenceOf(const CellPlan& plan) {
        if (!plan.reference) return nullptr;
        const fs::path folder = plan.reference->parent_path(), variance = folder / "variance.exr";
        if (!fs::exists(variance)) return nullptr;
        if (referenceFolder_ != folder) {
            const Json result = readJsonIfThere(folder / "result.json");
            const double parts = result.is_object() ? result.value("replicates", 0.0) : 0;
            reference_ = {readImage(plan.reference->string()), readImage(variance.string()),
                          parts > 1 ? parts - 1 : std::numeric_limits<double>::infinity()};
            referenceFolder_ = folder;
        }
        return &reference_;
    }

    void embedTechniques(const CellPlan& plan, Json& ids) {
        for (const auto& technique : plan.techniques) {
            Json entry = {{"s", technique.first}, {"t", technique.second}};
            for (const char* kind : {"weighted", "unweighted"})
                entry[kind] = elements_.add(
                    shrink(readImage(techniqueFile(plan.folder(), technique, kind).string()), techniqueFactor_));
            ids["techniques"].push_back(entry);
        }
    }

    void embedChains(const CellPlan& plan, Json& ids) {
        if (!hasChains(plan)) return;
        const double draws = plan.result["traces"].at("draws").get<double>();
        const int most = int(chainShare_ / base64Size(kDrawBytes * std::max(1.0, draws)));
        auto chains = readChainData(plan.folder(), plan.result, most);
        if (!chains) return;
        ids["chains"] = std::move(chains->fields);
        ids["chains"].update({{"replicate", plan.median},
                              {"all", plan.result.value("chains", 0.0)},
                              {"mutations", plan.result.value("mutations", 0.0)},
                              {"mixing", plan.result.value("mixing", Json())}});
        ids["chains"]["data"] = elements_.add(Json::object(), chains->bytes);
    }

    std::vector<CellPlan> plans_;
    Sizes sizes_;
    int techniqueFactor_ = 1;
    double chainShare_ = 0;  ///< bytes for the chains of one cell
    fs::path referenceFolder_;
    MapReference reference_;
    Elements elements_;
    std::map<fs::path, std::size_t> files_;
};

}  // namespace

Json readJsonIfThere(const fs::path& path) {
    return fs::exists(path) ? JsonDocument::fromFile(path).json() : Json();
}

PagePictures gatherPictures(const fs::path& runDir, const Json& cells, const std::string& metric) {
    std::vector<CellPlan> plans;
    for (const Json& cell : cells) plans.push_back(planCell(runDir, cell, metric));
    return Gatherer(std::move(plans)).gather();
}

}  // namespace ulam
