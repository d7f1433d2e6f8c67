#include "experiments/report/replicate_maps.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/image/image_io.h"
#include "experiments/report/picture_code.h"
#include "experiments/statistics/features.h"
#include "experiments/statistics/holm.h"

namespace ulam {
namespace {

std::uint8_t deviationByte(double relative) {
    if (!(relative > 0)) return 0;
    return std::uint8_t(std::lround(std::clamp(1 + (std::log10(relative) + 3) * 254 / 6, 1.0, 255.0)));
}

/// Mean and sum of squared deviations of each block's luminance over replicates (Welford 1962).
class Moments {
public:
    void add(const Image& image) {
        if (count_ == 0) {
            mean_.resize(image.pixels.size());
            squares_.resize(image.pixels.size());
        }
        ++count_;
        for (std::size_t i = 0; i < mean_.size(); ++i) {
            const double x = luminance(Spectrum(image.pixels[i])), difference = x - mean_[i];
            mean_[i] += difference / double(count_);
            squares_[i] += difference * (x - mean_[i]);
        }
    }
    std::vector<std::uint8_t> deviations() const {
        std::vector<std::uint8_t> bytes;
        for (std::size_t i = 0; i < mean_.size(); ++i) {
            const double variance = count_ < 2 ? 0 : squares_[i] / double(count_ - 1);
            bytes.push_back(deviationByte(std::sqrt(variance / (mean_[i] * mean_[i] + 0.01))));
        }
        return bytes;
    }

private:
    std::size_t count_ = 0;
    std::vector<double> mean_, squares_;
};

std::uint8_t testByte(double p, bool bright) {
    const double size = std::min(127.0, std::round(-20 * std::log10(p)));
    return std::uint8_t(bright ? 128 + size : 128 - size);
}

std::vector<float> luminances(const Image& image) {
    std::vector<float> values;
    for (const Rgb& pixel : image.pixels) values.push_back(float(luminance(Spectrum(pixel))));
    return values;
}

/// The same of blocks twice as large.
Image halve(const Image& image) {
    return shrink(image, 2);
}

Image squareRoots(const Image& variance) {
    Image roots = variance;
    for (Rgb& pixel : roots.pixels)
        for (int c = 0; c < 3; ++c) pixel[c] = std::sqrt(std::max(0.0f, pixel[c]));
    return roots;
}

/// p of every block that can be judged.
std::vector<std::optional<double>> testBlocks(const std::vector<std::vector<float>>& replicates,
                                              const std::vector<float>& truth, const std::vector<float>& deviation,
                                              double degrees) {
    std::vector<std::optional<double>> p(truth.size());
    std::vector<double> column(replicates.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
        std::ranges::transform(replicates, column.begin(), [i](const std::vector<float>& r) { return r[i]; });
        if (std::ranges::adjacent_find(column, std::ranges::not_equal_to()) == column.end()) continue;
        p[i] = statistics::skewedMeanP(column, {truth[i], double(deviation[i]) * deviation[i], degrees});
    }
    return p;
}

ByteMap encodeTests(const std::vector<std::optional<double>>& p, const std::vector<std::vector<float>>& replicates,
                    const std::vector<float>& truth, ByteMap map) {
    std::vector<double> judged;
    for (const auto& value : p)
        if (value) judged.push_back(*value);
    const std::vector<double> adjusted = statistics::benjaminiHochbergAdjusted(judged);
    map.bytes.assign(p.size(), 0);
    std::size_t next = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (!p[i]) continue;
        double mean = 0;
        for (const std::vector<float>& r : replicates) mean += double(r[i]) / double(replicates.size());
        map.bytes[i] = testByte(adjusted[next++], mean > truth[i]);
    }
    return map;
}

/// Images that shrink together until enough of their blocks can be judged.
ByteMap testMap(std::vector<Image> replicates, const MapReference& reference, int block, int largest) {
    Image truth = shrink(reference.image, block), deviation = shrink(squareRoots(reference.variance), block);
    for (;;) {
        std::vector<std::vector<float>> values;
        for (const Image& image : replicates) values.push_back(luminances(image));
        const std::vector<float> expected = luminances(truth);
        const auto p = testBlocks(values, expected, luminances(deviation), reference.degrees);
        const auto judged = std::ranges::count_if(p, [](const auto& value) { return value.has_value(); });
        if (double(judged) >= kJudgedShare * double(p.size()) || 2 * block > largest || p.size() == 1)
            return encodeTests(p, values, expected, {block, truth.width, truth.height, {}});
        for (Image& image : replicates) image = halve(image);
        truth = halve(truth);
        deviation = halve(deviation);
        block *= 2;
    }
}

}  // namespace

ReplicateMaps mapReplicates(const std::vector<std::filesystem::path>& files, const MapReference* reference, int block) {
    std::vector<Spectrum> total;
    Moments moments;
    std::vector<Image> small;  // of all replicates, for the tests
    int tested = block;
    ReplicateMaps maps;
    Image& mean = maps.mean;
    for (const std::filesystem::path& file : files) {
        const Image image = readImage(file.string());
        if (total.empty()) {
            mean = Image(image.width, image.height);
            total.resize(image.pixels.size(), Spectrum(0));
            if (reference &&
                (files.size() < 2 || reference->image.width != image.width || reference->image.height != image.height))
                reference = nullptr;
            while (double(total.size()) * double(files.size()) / (double(tested) * tested) > kTestedBlocks) tested *= 2;
        }
        if (image.width != mean.width || image.height != mean.height) {
            fail(ExitCode::InvalidConfig, "{}: expected {} x {} pixels as in the other replicates, found {} x {}",
                 file.string(), mean.width, mean.height, image.width, image.height);
        }
        for (std::size_t i = 0; i < total.size(); ++i) total[i] += Spectrum(image.pixels[i]);
        moments.add(shrink(image, block));
        if (reference) small.push_back(shrink(image, tested));
    }
    for (std::size_t i = 0; i < total.size(); ++i) mean.pixels[i] = Rgb(total[i] / double(files.size()));
    maps.deviation = {block, (mean.width + block - 1) / block, (mean.height + block - 1) / block, moments.deviations()};
    if (reference) maps.tests = testMap(std::move(small), *reference, tested, kLargestBlock * block);
    return maps;
}

}  // namespace ulam
