#include "experiments/report/page_sizes.h"

#include <algorithm>
#include <set>

#include "core/image/image_io.h"
#include "experiments/report/chain_data.h"
#include "experiments/report/chain_maps.h"
#include "experiments/report/picture_code.h"
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

/// What the images of all cells take. A sweep or a scene may give a cell a film of its own.
struct Sizes {
    double largest = 0;                           ///< film, in pixels
    double pictures = 0, maps = 0, techniques = 0;  ///< bytes of base64 of all, not shrunk, pictures as RGB9E5
};

double pixelsOf(const fs::path& image) {
    return double(readImage(image.string()).pixels.size());
}

Sizes sizesOf(const std::vector<CellPlan>& plans) {
    Sizes sizes;
    std::set<fs::path> references;
    for (const CellPlan& plan : plans) {
        if (plan.reference && references.insert(*plan.reference).second) sizes.pictures += base64Size(4 * pixelsOf(*plan.reference));
        if (plan.replicates.empty()) continue;
        const double pixels = pixelsOf(plan.folder() / "image.exr");
        sizes.largest = std::max(sizes.largest, pixels);
        sizes.pictures += base64Size(4 * kPicturesOfCell * pixels);
        // A map has a byte for a block.
        const double chainMaps = plan.hasChains() ? 1 + 1.0 / (kRhatBlock * kRhatBlock) : 0;
        sizes.maps += base64Size((plan.reference ? 2 : 1) + chainMaps) * pixels;
        sizes.techniques += base64Size(4 * 2 * double(plan.techniques.size()) * pixels);
    }
    return sizes;
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

/// Pictures and maps in what the rest leaves.
void fitPictures(const std::vector<CellPlan>& plans, const Sizes& full, double most, PageSizes& sizes) {
    sizes.exact = full.pictures + full.maps <= most;
    if (sizes.exact) return;
    sizes.maps = shrinkFactor(full.maps, kMapShare * most);
    const double left = most - full.maps / (double(sizes.maps) * sizes.maps);
    while (sizes.pictures * sizes.pictures < full.largest && !jpegsFit(plans, sizes.pictures, left)) ++sizes.pictures;
}

}  // namespace

PageSizes choosePageSizes(const std::vector<CellPlan>& plans) {
    const Sizes full = sizesOf(plans);
    double chains = 0, chainBytes = 0;
    for (const CellPlan& plan : plans) {
        if (!plan.hasChains()) continue;
        ++chains;
        const Json& traces = plan.result["traces"];
        chainBytes += base64Size(kDrawBytes * traces.at("chains").get<double>() * traces.at("draws").get<double>());
    }
    PageSizes sizes;
    sizes.techniques = std::max(shrinkFactor(full.techniques, kTechniqueBytes),
                                shrinkFactor(full.largest, double(kTechniqueEdge) * kTechniqueEdge));
    if (chains > 0) sizes.chainBytes = kChainBytes / chains;
    const double others =
        full.techniques / (double(sizes.techniques) * sizes.techniques) + std::min(chainBytes, kChainBytes);
    fitPictures(plans, full, kReportImageBytes - others, sizes);
    return sizes;
}

}  // namespace ulam
