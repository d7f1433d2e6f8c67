#pragma once
// Error metrics. Each is defined once, with its constants, and every number Ulam reports comes from here.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/image.h"

namespace ulam {

struct MetricConstant {
    std::string_view name;
    double value;
};

/// A metric is a map of errors, one number a pixel, row by row from the top (0 = no error, larger is worse), and a
/// function of the map's mean: the mean itself for all but psnr and ssim.
struct Metric {
    using Map = std::vector<double>;
    using Images = std::span<const Image* const>;

    std::string_view name;
    std::string_view definition;  // one line
    std::span<const MetricConstant> constants;
    bool debiased;        // the variance of the reference is subtracted; then a map and its mean may be negative
    bool higherIsBetter;  // psnr and ssim

    std::vector<Map> (*computeMaps)(Images images, const Image& reference, const Image* referenceVariance);
    double (*fromMeanError)(double meanError);

    /// Of images of the reference's size, a map of each: many at once are faster where the metric must look at the
    /// reference for long. `referenceVariance` is the variance of the mean reference image per pixel and channel, zero
    /// where null; metrics that are not debiased ignore it.
    /// Throws ExitCode::InvalidConfig if the sizes differ or an image is empty.
    std::vector<Map> errorMaps(Images images, const Image& reference, const Image* referenceVariance = nullptr) const;
    /// Of one image.
    Map errorMap(const Image& image, const Image& reference, const Image* referenceVariance = nullptr) const;
    /// The metric from its map. The psnr of equal images is infinite.
    double value(const Map& map) const;
    /// The same without the floor(0.001 n) pixels of largest error: what is left when fireflies are forgiven.
    double trimmedValue(const Map& map) const;
    /// value(errorMap(...)).
    double evaluate(const Image& image, const Image& reference, const Image* referenceVariance = nullptr) const;
};

/// Throws ExitCode::InvalidConfig, naming the file and the pixel, where a value of a variance is negative or not
/// finite: debiasing with it would make an error of its own.
void requireVariance(const Image& variance, const std::string& file);

/// The share of pixels a trimmed value leaves out.
inline constexpr double kTrimmedShare = 0.001;

/// mse, mae, relmse, mape, smape, psnr, ssim, flip.
std::span<const Metric> metrics();
/// Throws ExitCode::InvalidConfig with the known names.
const Metric& findMetric(std::string_view name);

}  // namespace ulam
