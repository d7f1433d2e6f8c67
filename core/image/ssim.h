#pragma once
// Structural similarity. Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to
// Structural Similarity", IEEE Transactions on Image Processing 13(4), 2004, equation 13.

#include <vector>

#include "core/image/image.h"

namespace ulam {

inline constexpr double kSsimSigma = 1.5;  // of the Gaussian window, in pixels
inline constexpr int kSsimRadius = 5;      // the window has 11 x 11 pixels
inline constexpr double kSsimK1 = 0.01;
inline constexpr double kSsimK2 = 0.03;

/// 1 - SSIM around each pixel, row by row from the top, in [0, 2]; of luminance clamped to [0, 1] and sRGB-encoded, so
/// that the dynamic range L is 1. At the border the window is cut to the image and its weights are renormalised.
/// The images have the same size.
std::vector<double> ssimErrorMap(const Image& image, const Image& reference);

}  // namespace ulam
