#include "core/image/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "core/base/error.h"
#include "core/image/flip.h"
#include "core/image/ssim.h"

namespace ulam {
namespace {

constexpr double kEpsilon = 0.01;  // of relmse (added to the square), mape and smape
constexpr double kPsnrPeak = 1;

// Errors of one channel: x of the image, r of the reference, v the variance of r.
double squared(double x, double r, double v) {
    return (x - r) * (x - r) - v;
}
double absolute(double x, double r, double) {
    return std::abs(x - r);
}
double relativeSquared(double x, double r, double v) {
    return squared(x, r, v) / (r * r + kEpsilon);
}
double relativeAbsolute(double x, double r, double) {
    return std::abs(x - r) / (std::abs(r) + kEpsilon);
}
double symmetric(double x, double r, double) {
    return std::abs(x - r) / (std::abs(x) + std::abs(r) + kEpsilon);
}
double squaredAsMeasured(double x, double r, double) {
    return squared(x, r, 0);
}

/// The mean over the three channels.
template <double channelError(double x, double r, double v)>
Metric::Map channelMap(const Image& image, const Image& reference, const Image* variance) {
    std::vector<double> map;
    map.reserve(image.pixels.size());
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const Rgb &x = image.pixels[i], &r = reference.pixels[i];
        const Rgb v = variance ? variance->pixels[i] : Rgb(0);
        map.push_back((channelError(x.x, r.x, v.x) + channelError(x.y, r.y, v.y) + channelError(x.z, r.z, v.z)) / 3);
    }
    return map;
}

Metric::Map ssimMap(const Image& image, const Image& reference, const Image*) {
    return ssimErrorMap(image, reference);
}

template <Metric::Map map(const Image& image, const Image& reference, const Image* variance)>
std::vector<Metric::Map> each(Metric::Images images, const Image& reference, const Image* variance) {
    std::vector<Metric::Map> maps;
    for (const Image* image : images) maps.push_back(map(*image, reference, variance));
    return maps;
}
std::vector<Metric::Map> flipMaps(Metric::Images images, const Image& reference, const Image*) {
    return flipErrorMaps(images, reference);
}

double same(double mean) {
    return mean;
}
double psnrFromMse(double mse) {
    return 10 * std::log10(kPsnrPeak * kPsnrPeak / mse);
}
double ssimFromError(double mean) {
    return 1 - mean;
}

constexpr std::array<MetricConstant, 1> kEpsilonConstant{{{"epsilon", kEpsilon}}};
constexpr std::array<MetricConstant, 1> kPsnrConstants{{{"peak", kPsnrPeak}}};
constexpr std::array<MetricConstant, 5> kSsimConstants{
    {{"window", 2 * kSsimRadius + 1}, {"sigma", kSsimSigma}, {"k1", kSsimK1}, {"k2", kSsimK2}, {"range", 1}}};
constexpr std::array<MetricConstant, 1> kFlipConstants{{{"pixels_per_degree", kFlipPixelsPerDegree}}};

const std::array<Metric, 8> kMetrics{{
    {"mse", "mean (x - r)^2 - Var(r)", {}, true, false, each<channelMap<squared>>, same},
    {"mae", "mean |x - r|", {}, false, false, each<channelMap<absolute>>, same},
    {"relmse", "mean ((x - r)^2 - Var(r)) / (r^2 + epsilon)", kEpsilonConstant, true, false,
     each<channelMap<relativeSquared>>, same},
    {"mape", "mean |x - r| / (|r| + epsilon), a ratio, not per cent", kEpsilonConstant, false, false,
     each<channelMap<relativeAbsolute>>, same},
    {"smape", "mean |x - r| / (|x| + |r| + epsilon), between 0 and 1", kEpsilonConstant, false, false,
     each<channelMap<symmetric>>, same},
    {"psnr", "10 log10(peak^2 / mean (x - r)^2) in decibels", kPsnrConstants, false, true,
     each<channelMap<squaredAsMeasured>>, psnrFromMse},
    {"ssim", "structural similarity (Wang et al. 2004) of sRGB-encoded luminance clamped to [0, 1]", kSsimConstants,
     false, true, each<ssimMap>, ssimFromError},
    {"flip", "HDR-FLIP (Andersson et al. 2020, 2021): mean over pixels of the largest error over exposures, ACES",
     kFlipConstants, false, false, flipMaps, same},
}};

double mean(const double* begin, std::size_t count) {
    return std::accumulate(begin, begin + count, 0.0) / static_cast<double>(count);
}

}  // namespace

std::vector<Metric::Map> Metric::errorMaps(Images images, const Image& reference,
                                           const Image* referenceVariance) const {
    const auto sameSize = [&](const Image& other) {
        return other.width == reference.width && other.height == reference.height;
    };
    for (const Image* image : images) {
        if (image->pixels.empty() || !sameSize(*image)) {
            fail(ExitCode::InvalidConfig,
                 "{}: expected two images of one size; found {} x {} and a reference of {} x {}", name, image->width,
                 image->height, reference.width, reference.height);
        }
    }
    if (referenceVariance && !sameSize(*referenceVariance)) {
        fail(ExitCode::InvalidConfig, "{}: expected the variance of a reference of {} x {}; found {} x {}", name,
             reference.width, reference.height, referenceVariance->width, referenceVariance->height);
    }
    return computeMaps(images, reference, referenceVariance);
}

Metric::Map Metric::errorMap(const Image& image, const Image& reference, const Image* referenceVariance) const {
    const Image* const one = &image;
    return std::move(errorMaps({&one, 1}, reference, referenceVariance).front());
}

double Metric::evaluate(const Image& image, const Image& reference, const Image* referenceVariance) const {
    return value(errorMap(image, reference, referenceVariance));
}

double Metric::value(const Map& map) const {
    return fromMeanError(mean(map.data(), map.size()));
}

double Metric::trimmedValue(const Map& map) const {
    const auto kept = map.size() - static_cast<std::size_t>(kTrimmedShare * static_cast<double>(map.size()));
    Map parted = map;
    if (kept < map.size())
        std::nth_element(parted.begin(), parted.begin() + static_cast<std::ptrdiff_t>(kept), parted.end());
    return fromMeanError(mean(parted.data(), kept));
}

void requireVariance(const Image& variance, const std::string& file) {
    for (int y = 0; y < variance.height; ++y) {
        for (int x = 0; x < variance.width; ++x) {
            const Rgb& p = variance.at(x, y);
            for (const float v : {p.x, p.y, p.z}) {
                if (!(v >= 0 && std::isfinite(v)))
                    fail(ExitCode::InvalidConfig,
                         "{}: expected variances, finite and not negative; found ({}, {}, {}) in pixel ({}, {})", file,
                         p.x, p.y, p.z, x, y);
            }
        }
    }
}

std::span<const Metric> metrics() {
    return kMetrics;
}

const Metric& findMetric(std::string_view name) {
    const auto found = std::find_if(kMetrics.begin(), kMetrics.end(), [&](const Metric& m) { return m.name == name; });
    if (found == kMetrics.end()) {
        std::vector<std::string_view> names;
        for (const Metric& metric : kMetrics) names.push_back(metric.name);
        fail(ExitCode::InvalidConfig, "unknown metric \"{}\": expected one of {}", name, fmt::join(names, ", "));
    }
    return *found;
}

}  // namespace ulam
