#pragma once
// HDR-FLIP: how different two images look when flipped on a screen, over all exposures at which they might be shown.
// Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020 (LDR-FLIP);
// Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics Short Papers 2021
// (HDR-FLIP).

#include <span>
#include <vector>

#include "core/image/image.h"

namespace ulam {

/// A screen 0.7 m wide with 3840 pixels across, seen from 0.7 m: 0.7 * 3840 / 0.7 * pi / 180.
inline constexpr double kFlipPixelsPerDegree = 67.020643276582255;

/// The exposures, in stops, at which a reference is shown: `count` equidistant ones from `start` to `stop`.
struct FlipExposures {
    double start;
    double stop;
    int count;
};
/// From the brightest pixel and the median luminance of the reference.
FlipExposures flipExposures(const Image& reference);

/// Of each image one FLIP error in [0, 1] a pixel, row by row from the top: the largest over the exposures. Negative
/// values count as zero. The images have the reference's size.
std::vector<std::vector<double>> flipErrorMaps(std::span<const Image* const> images, const Image& reference);

}  // namespace ulam
