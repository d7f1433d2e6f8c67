#include "experiments/report/chain_maps.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/image/image_io.h"
#include "experiments/report/cell_plan.h"
#include "experiments/report/picture_code.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

/// Luminance of each pixel, in units of the run's normalization.
std::vector<double> densities(const Image& image, double normalization) {
    std::vector<double> values;
    for (const Rgb& pixel : image.pixels) values.push_back(luminance(Spectrum(pixel)) / normalization);
    return values;
}

/// A run cut in two.
struct Halves {
    int width = 0, height = 0;
    std::vector<double> first, whole;    ///< means of so many mutations
    double firstSteps = 0, allSteps = 0;
};

std::optional<Halves> readHalves(const fs::path& folder, int block) {
    const Json result = readJsonIfThere(folder / "result.json");
    if (!result.is_object()) return {};
    const Json snapshots = result.value("snapshots", Json::array());
    const double steps = result.value("mutations", 0.0), normalization = result.value("normalization", 0.0);
    if (snapshots.empty() || !(normalization > 0)) return {};
    const double first = snapshots.back().value("mutations", 0.0);
    if (!(first > 0) || !(first < steps)) return {};
    const Image whole = shrink(readImage((folder / "image.exr").string()), block);
    const Image half = shrink(readImage((folder / snapshots.back().at("image").get<std::string>()).string()), block);
    if (half.width != whole.width || half.height != whole.height)
        fail(ExitCode::InvalidConfig, "{}: expected a snapshot of the image's size", folder.string());
    return Halves{whole.width, whole.height, densities(half, normalization), densities(whole, normalization), first, steps};
}

/// Variance of one mutation's deposit in each pixel, from the halves of runs and from whole runs.
class MixingMoments {
public:
    void add(const Halves& run) {
        if (within_.empty()) within_.resize(run.whole.size()), mean_ = squares_ = within_;
        ++runs_;
        steps_ += run.allSteps;
        const double second = run.allSteps - run.firstSteps;
        for (std::size_t i = 0; i < within_.size(); ++i) {
            // whole − first = (second − first) · second's share of the steps
            const double difference = (run.whole[i] - run.first[i]) * run.allSteps / second;
            within_[i] += difference * difference / (1 / run.firstSteps + 1 / second);
            const double step = run.whole[i] - mean_[i];
            mean_[i] += step / runs_;
            squares_[i] += step * (run.whole[i] - mean_[i]);
        }
    }

    double within(std::size_t i) const { return within_[i] / runs_; }
    double between(std::size_t i) const { return squares_[i] / (runs_ - 1) * steps_ / runs_; }

private:
    double runs_ = 0, steps_ = 0;
    std::vector<double> within_, mean_, squares_;
};

std::uint8_t rhatByte(double within, double between) {
    if (within == 0 && between == 0) return 0;
    const double rhat = std::sqrt((1 + between / within) / 2);
    return std::uint8_t(1 + std::lround(std::clamp(64 * (std::log2(rhat) + 1), 0.0, 254.0)));
}

int blocksOf(int pixels, int block) {
    return (pixels + block - 1) / block;
}

}  // namespace

std::optional<ByteMap> mapRhat(const std::vector<fs::path>& replicates, int block) {
    MixingMoments moments;
    std::optional<Halves> first;
    int runs = 0;
    for (const fs::path& folder : replicates) {
        const std::optional<Halves> run = readHalves(folder, block);
        if (!run) continue;
        if (!first) first = run;
        if (run->width != first->width || run->height != first->height)
            fail(ExitCode::InvalidConfig, "{}: expected an image of the same size as in the other replicates", folder.string());
        moments.add(*run);
        ++runs;
    }
    if (runs < 2) return {};
    ByteMap map{block * kRhatBlock, blocksOf(first->width, kRhatBlock), blocksOf(first->height, kRhatBlock), {}};
    for (int row = 0; row < map.height; ++row)
        for (int column = 0; column < map.width; ++column) {
            double within = 0, between = 0;
            for (int y = row * kRhatBlock; y < std::min(first->height, (row + 1) * kRhatBlock); ++y)
                for (int x = column * kRhatBlock; x < std::min(first->width, (column + 1) * kRhatBlock); ++x) {
                    const auto i = std::size_t(y) * std::size_t(first->width) + std::size_t(x);
                    within += moments.within(i), between += moments.between(i);
                }
            map.bytes.push_back(rhatByte(within, between));
        }
    return map;
}

std::optional<ByteMap> mapAcceptance(const std::vector<fs::path>& replicates, int block) {
    std::vector<double> proposed, accepted;
    ByteMap map{block, 0, 0, {}};
    for (const fs::path& folder : replicates) {
        const fs::path from = folder / "extra/proposed.exr", away = folder / "extra/accepted.exr";
        if (!fs::exists(from) || !fs::exists(away)) continue;
        const Image tried = shrink(readImage(from.string()), block), left = shrink(readImage(away.string()), block);
        if (proposed.empty()) {
            map.width = tried.width, map.height = tried.height;
            proposed.resize(tried.pixels.size()), accepted = proposed;
        }
        if (tried.pixels.size() != proposed.size() || left.pixels.size() != proposed.size())
            fail(ExitCode::InvalidConfig, "{}: expected an image of the same size as in the other replicates", from.string());
        for (std::size_t i = 0; i < proposed.size(); ++i) proposed[i] += tried.pixels[i].x, accepted[i] += left.pixels[i].x;
    }
    if (proposed.empty()) return {};
    for (std::size_t i = 0; i < proposed.size(); ++i)
        map.bytes.push_back(proposed[i] > 0 ? std::uint8_t(1 + std::lround(254 * std::min(1.0, accepted[i] / proposed[i]))) : 0);
    return map;
}

}  // namespace ulam
