#pragma once
// The sRGB transfer function (IEC 61966-2-1).

#include <cmath>

namespace ulam {

/// Linear light in [0, 1] to the encoded value in [0, 1].
inline double linearToSrgb(double v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

/// The encoded value in [0, 1] to linear light in [0, 1].
inline double srgbToLinear(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

}  // namespace ulam
