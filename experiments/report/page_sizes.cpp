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

/// The film is the experiment's, so one image tells the size of all.
double pixelsOf(const std::vector<CellPlan>& plans) {
    for (const CellPlan& plan : plans)
        if (!plan.replicates.empty()) return double(readImage((plan.folder() / "image.exr").string()).pixels.size());
    return 0;
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
        if (plan.hasChains()) bytes += 1 + 1.0 / (kRhatBlock * kRhatBlock);
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

/// Pictures and maps in what the rest leaves.
void fitPictures(const std::vector<CellPlan>& plans, double pixels, double most, PageSizes& sizes) {
    const double bytesOfMaps = pixels * mapBytes(plans);
    sizes.exact = pixels * exactPictureBytes(plans) + bytesOfMaps <= most;
    if (sizes.exact) return;
    sizes.maps = shrinkFactor(bytesOfMaps, kMapShare * most);
    const double left = most - bytesOfMaps / (double(sizes.maps) * sizes.maps);
    while (sizes.pictures * sizes.pictures < pixels && !jpegsFit(plans, sizes.pictures, left)) ++sizes.pictures;
}

}  // namespace

PageSizes choosePageSizes(const std::vector<CellPlan>& plans) {
    const double pixels = pixelsOf(plans);
    double techniques = 0, chains = 0, chainBytes = 0;
    for (const CellPlan& plan : plans) {
        techniques += 2 * double(plan.techniques.size());
        if (!plan.hasChains()) continue;
        ++chains;
        const Json& traces = plan.result["traces"];
        chainBytes += base64Size(kDrawBytes * traces.at("chains").get<double>() * traces.at("draws").get<double>());
    }
    PageSizes sizes;
    const double techniqueBytes = base64Size(4 * techniques * pixels);
    sizes.techniques = std::max(shrinkFactor(techniqueBytes, kTechniqueBytes),
                                shrinkFactor(pixels, double(kTechniqueEdge) * kTechniqueEdge));
    if (chains > 0) sizes.chainBytes = kChainBytes / chains;
    const double others =
        techniqueBytes / (double(sizes.techniques) * sizes.techniques) + std::min(chainBytes, kChainBytes);
    fitPictures(plans, pixels, kReportImageBytes - others, sizes);
    return sizes;
}

}  // namespace ulam
