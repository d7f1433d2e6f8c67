#include "experiments/report/report_pictures.h"

#include <fmt/format.h>

#include <limits>
#include <map>
#include <string_view>
#include <vector>

#include "core/image/image_io.h"
#include "experiments/report/cell_plan.h"
#include "experiments/report/chain_data.h"
#include "experiments/report/chain_maps.h"
#include "experiments/report/page_sizes.h"
#include "experiments/report/picture_code.h"
#include "experiments/report/replicate_maps.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

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
    std::size_t addJpeg(const Image& image, int quality) {
        const JpegPicture picture = encodeJpegPicture(image, quality);
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

class Gatherer {
public:
    Gatherer(std::vector<CellPlan> plans, double room)
        : plans_(std::move(plans)), sizes_(choosePageSizes(plans_, room)) {}

    PagePictures gather() {
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
        return sizes_.exact ? elements_.add(small) : elements_.addJpeg(small, sizes_.quality);
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
        if (!plan.hasChains()) return;
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
                    shrink(readImage(techniqueFile(plan.folder(), technique, kind).string()), sizes_.techniques));
            ids["techniques"].push_back(entry);
        }
    }

    void embedChains(const CellPlan& plan, Json& ids) {
        if (!plan.hasTraces()) return;
        const double draws = plan.result["traces"].at("draws").get<double>();
        const int most = int(sizes_.chainBytes / base64Size(kDrawBytes * std::max(1.0, draws)));
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
    PageSizes sizes_;
    fs::path referenceFolder_;
    MapReference reference_;
    Elements elements_;
    std::map<fs::path, std::size_t> files_;
};

}  // namespace

PagePictures gatherPictures(const fs::path& runDir, const Json& cells, const std::string& metric, double room) {
    std::vector<CellPlan> plans;
    for (const Json& cell : cells) plans.push_back(planCell(runDir, cell, metric));
    return Gatherer(std::move(plans), room).gather();
}

}  // namespace ulam
