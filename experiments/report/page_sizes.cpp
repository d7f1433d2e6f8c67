#include "experiments/report/page_sizes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "core/image/image_io.h"
#include "experiments/report/chain_data.h"
#include "experiments/report/chain_maps.h"
#include "experiments/report/picture_code.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

// At most these shares of the room for what is the same size whatever the film is.
constexpr double kTechniqueShare = 1.0 / 6;
constexpr double kChainShare = 1.0 / 6;
constexpr int kTechniqueEdge = 128;  ///< pixels, of the images of techniques
/// Share of the rest for maps, where not every pixel has room.
constexpr double kMapShare = 0.2;
/// Of JPEG. With the first the amount of noise stays; the others keep more of each pixel.
constexpr std::array kQualities{90, 94, 97, 99, 100};

/// What the images of all cells take. A sweep or a scene may give a cell a film of its own.
struct Sizes {
    double largest = 0;                           ///< film, in pixels
    double pictures = 0, maps = 0, techniques = 0;  ///< bytes of base64 of all, not shrunk, pictures as RGB9E5
};

/// Mean, median and worst replicate, of which the last two may be one.
int picturesOf(const CellPlan& plan) {
    return plan.median == plan.worst ? 2 : 3;
}

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
        sizes.pictures += base64Size(4 * picturesOf(plan) * pixels);
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

/// The best quality with which the pictures of all cells, shrunk, fit as JPEG; the replicates of a cell and their mean
/// are taken to be as long as its median replicate.
std::optional<int> fittingQuality(const std::vector<CellPlan>& plans, int factor, double most) {
    std::array<double, kQualities.size()> left;
    left.fill(most);
    const auto take = [&](const fs::path& file, int times) {
        const Image image = shrink(readImage(file.string()), factor);
        for (std::size_t i = 0; i < left.size() && left[i] >= 0 && left.front() >= 0; ++i)
            left[i] -= times * base64Size(double(encodeJpegPicture(image, kQualities[i]).bytes.size()));
    };
    std::set<fs::path> references;
    for (const CellPlan& plan : plans) {
        if (plan.reference && references.insert(*plan.reference).second) take(*plan.reference, 1);
        if (!plan.replicates.empty()) take(plan.folder() / "image.exr", picturesOf(plan));
        if (left.front() < 0) return std::nullopt;
    }
    return kQualities[std::size_t(std::ranges::count_if(left, [](double bytes) { return bytes >= 0; })) - 1];
}

/// Pictures and maps in what the rest leaves.
void fitPictures(const std::vector<CellPlan>& plans, const Sizes& full, double most, PageSizes& sizes) {
    sizes.exact = full.pictures + full.maps <= most;
    if (sizes.exact) return;
    sizes.maps = shrinkFactor(full.maps, kMapShare * most);
    const double left = most - full.maps / (double(sizes.maps) * sizes.maps);
    for (;; ++sizes.pictures) {
        const auto quality = fittingQuality(plans, sizes.pictures, left);
        sizes.quality = quality.value_or(kQualities.front());
        if (quality || sizes.pictures * sizes.pictures >= full.largest) return;
    }
}

}  // namespace

PageSizes choosePageSizes(const std::vector<CellPlan>& plans, double room) {
    const Sizes full = sizesOf(plans);
    double chains = 0, chainBytes = 0;
    for (const CellPlan& plan : plans) {
        if (!plan.hasTraces()) continue;
        ++chains;
        const Json& traces = plan.result["traces"];
        chainBytes += base64Size(kDrawBytes * traces.at("chains").get<double>() * traces.at("draws").get<double>());
    }
    PageSizes sizes;
    sizes.techniques = std::max(shrinkFactor(full.techniques, kTechniqueShare * room),
                                shrinkFactor(full.largest, double(kTechniqueEdge) * kTechniqueEdge));
    if (chains > 0) sizes.chainBytes = kChainShare * room / chains;
    const double others =
        full.techniques / (double(sizes.techniques) * sizes.techniques) + std::min(chainBytes, kChainShare * room);
    fitPictures(plans, full, room - others, sizes);
    return sizes;
}

}  // namespace ulam
