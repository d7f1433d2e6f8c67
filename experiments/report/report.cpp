#include "experiments/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/json.h"
#include "core/image/image_io.h"
#include "experiments/report/page.h"
#include "experiments/report/picture_code.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

Json readJson(const fs::path& path) {
    return JsonDocument::fromFile(path).json();
}
Json readJsonIfThere(const fs::path& path) {
    return fs::exists(path) ? readJson(path) : Json();
}

fs::path replicateFolder(const fs::path& cellFolder, std::size_t replicate) {
    return cellFolder / fmt::format("r{:03}", replicate);
}

/// The replicates of a cell that left an image, by number.
std::map<std::size_t, fs::path> replicateImages(const fs::path& cellFolder) {
    std::map<std::size_t, fs::path> images;
    if (!fs::exists(cellFolder)) return images;
    for (const fs::directory_entry& entry : fs::directory_iterator(cellFolder)) {
        const std::string name = entry.path().filename().string();
        std::size_t replicate = 0;
        const char* const end = name.data() + name.size();
        const bool numbered = name.starts_with('r') && std::from_chars(name.data() + 1, end, replicate).ptr == end;
        const fs::path image = entry.path() / "image.exr";
        if (numbered && fs::exists(image)) images.emplace(replicate, image);
    }
    return images;
}

Image readMean(const std::map<std::size_t, fs::path>& files) {
    Image mean;
    std::vector<Spectrum> total;
    for (const auto& [replicate, file] : files) {
        const Image image = readImage(file.string());
        if (total.empty()) {
            mean = Image(image.width, image.height);
            total.resize(image.pixels.size(), Spectrum(0));
        }
        if (image.width != mean.width || image.height != mean.height) {
            fail(ExitCode::InvalidConfig, "{}: expected {} x {} pixels as in the other replicates, found {} x {}",
                 file.string(), mean.width, mean.height, image.width, image.height);
        }
        for (std::size_t i = 0; i < total.size(); ++i) total[i] += Spectrum(image.pixels[i]);
    }
    for (std::size_t i = 0; i < total.size(); ++i) mean.pixels[i] = Rgb(total[i] / double(files.size()));
    return mean;
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

/// Pictures as the page wants them: sizes in a table, texts in elements of their own, so that the browser parses only
/// what it shows.
class Pictures {
public:
    explicit Pictures(int factor) : factor_(factor) {}

    std::size_t add(const Image& image) {
        const Image small = shrink(image, factor_);
        const std::size_t id = sizes_.size();
        sizes_.push_back({{"width", small.width}, {"height", small.height}});
        elements_ += fmt::format("<script type=\"text/plain\" id=\"image-{}\">{}</script>\n", id,
                                 encodeBase64(encodeRgb9e5(small)));
        return id;
    }

    std::size_t addFile(const fs::path& file) {
        const auto known = files_.find(file);
        return known != files_.end() ? known->second : files_[file] = add(readImage(file.string()));
    }

    const Json& sizes() const { return sizes_; }
    const std::string& elements() const { return elements_; }

private:
    int factor_;
    Json sizes_ = Json::array();
    std::string elements_;
    std::map<fs::path, std::size_t> files_;
};

/// What a cell shows, before any of it is read.
struct CellPictures {
    std::string cell;
    std::map<std::size_t, fs::path> replicates;
    std::size_t median = 0, worst = 0;
    std::optional<fs::path> reference;
};

CellPictures planCell(const fs::path& runDir, const Json& cell, const std::string& metric) {
    CellPictures plan;
    plan.cell = cell.at("cell").get<std::string>();
    plan.replicates = replicateImages(runDir / "cells" / plan.cell);
    plan.median = chooseReplicate(cell, "median_replicate", 0.5, metric);
    plan.worst = chooseReplicate(cell, "worst_replicate", 1, metric);
    const std::string reference = cell.value("reference_image", std::string());
    if (!reference.empty() && fs::exists(runDir / reference)) plan.reference = runDir / reference;
    return plan;
}

/// The smallest power of two by which all pictures shrink to fit into the page.
int shrinkFactor(const std::vector<CellPictures>& plans) {
    double bytes = 0;
    std::optional<double> pixels;  // the film is the experiment's, so one image tells the size of all
    for (const CellPictures& plan : plans) {
        if (plan.replicates.empty()) continue;
        if (!pixels) pixels = double(readImage(plan.replicates.begin()->second.string()).pixels.size());
        const double pictures = plan.reference ? 4 : 3;
        bytes += pictures * 4 * *pixels * 4 / 3;  // 4 bytes a pixel, base64
    }
    int factor = 1;
    while (bytes / (double(factor) * factor) > kReportImageBytes) factor *= 2;
    return factor;
}

Json embedCell(const CellPictures& plan, Pictures& pictures) {
    Json ids = Json::object();
    if (plan.reference) ids["reference"] = pictures.addFile(*plan.reference);
    if (plan.replicates.empty()) return ids;
    ids["mean"] = pictures.add(readMean(plan.replicates));
    for (const auto& [name, replicate] : {std::pair{"median", plan.median}, std::pair{"worst", plan.worst}}) {
        const auto found = plan.replicates.find(replicate);
        const auto& [shown, file] = found != plan.replicates.end() ? *found : *plan.replicates.begin();
        ids[name] = pictures.addFile(file);
        ids[fmt::format("{}_replicate", name)] = shown;
    }
    return ids;
}

/// JSON that cannot end the element it stands in.
std::string scriptSafe(const Json& json) {
    std::string text;
    for (const char c : json.dump()) {
        if (c == '<')
            text += "\\u003c";
        else
            text += c;
    }
    return text;
}

std::string htmlText(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '&')
            safe += "&amp;";
        else if (c == '<')
            safe += "&lt;";
        else
            safe += c;
    }
    return safe;
}

/// The template with every @NAME@ replaced; what is put in is not searched again.
std::string fill(std::string_view page, const std::map<std::string_view, std::string_view>& values) {
    std::string out;
    for (std::size_t at = 0; at < page.size();) {
        const std::size_t begin = page.find('@', at);
        const std::size_t end = begin == page.npos ? page.npos : page.find('@', begin + 1);
        out += page.substr(at, begin - at);
        if (end == page.npos) break;
        out += values.at(page.substr(begin + 1, end - begin - 1));
        at = end + 1;
    }
    return out;
}

std::string makePage(const fs::path& runDir, const Json& summary) {
    const Json cells = summary.value("cells", Json::array());
    const std::string metric = summary.value("primary_metric", std::string("relmse"));

    std::vector<CellPictures> plans;
    Json results = Json::object();
    for (const Json& cell : cells) {
        plans.push_back(planCell(runDir, cell, metric));
        const fs::path result = replicateFolder(runDir / "cells" / plans.back().cell, 0) / "result.json";
        if (fs::exists(result)) results[plans.back().cell] = readJson(result);
    }
    const int factor = shrinkFactor(plans);
    Pictures pictures(factor);
    Json shown = Json::object();
    for (const CellPictures& plan : plans) shown[plan.cell] = embedCell(plan, pictures);

    const Json data = {{"summary", summary},
                       {"experiment", readJsonIfThere(runDir / "experiment.json")},
                       {"resolved", readJsonIfThere(runDir / "resolved.json")},
                       {"provenance", readJsonIfThere(runDir / "provenance.json")},
                       {"results", results},
                       {"pictures", shown},
                       {"images", pictures.sizes()},
                       {"shrink", factor}};
    const std::string title = htmlText(summary.value("name", std::string("run")) + " · Ulam");
    const std::string json = scriptSafe(data);
    return fill(page::kTemplate, {{"TITLE", title},
                                  {"STYLE", page::kStyle},
                                  {"DATA", json},
                                  {"IMAGES", pictures.elements()},
                                  {"SCRIPT", page::kScript}});
}

}  // namespace

void writeReport(const fs::path& runDir) {
    const fs::path file = runDir / "summary.json";
    const Json summary = readJson(file);
    std::string page;
    try {
        page = makePage(runDir, summary);
    } catch (const Json::exception& error) {
        fail(ExitCode::InvalidConfig, "{}: expected the summary of a run, found another structure: {}", file.string(),
             error.what());
    }
    writeFileAtomically(runDir / "report.html", page);
}

}  // namespace ulam
