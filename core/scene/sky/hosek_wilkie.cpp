#include "core/scene/sky/hosek_wilkie.h"

#include "core/scene/sky/hosek_wilkie_data.h"

namespace ulam {
namespace {

using namespace sky_data;

/// A place between two neighbours of `count` tabulated ones.
struct Between {
    Between(double position, int count)
        : first(std::clamp(int(position), 0, count - 2)), fraction(std::clamp(position - first, 0.0, 1.0)) {}
    double operator()(double low, double high) const { return low + fraction * (high - low); }

    int first;
    double fraction;
};

/// A coefficient of the sky: linear in turbidity and albedo, a quintic Bézier curve over the cube root of the sun's
/// elevation, since much changes while the sun is low (Hosek & Wilkie 2012). A control point has 3 × `stride`
/// coefficients; `index` says which of them.
double coefficient(const float* table, int stride, int index, const Between& turbidity, double albedo, double elevation) {
    constexpr std::array<double, kControlPoints> kBinomials{1, 5, 10, 10, 5, 1};
    const double x = std::min(1.0, std::cbrt(elevation * 2 / kPi));
    const auto at = [&](int t, int a, int point) {
        return double(table[((t * kAlbedos + a) * kControlPoints + point) * 3 * stride + index]);
    };
    double sum = 0;
    for (int i = 0; i < kControlPoints; ++i) {
        const double bernstein = kBinomials[size_t(i)] * std::pow(x, i) * std::pow(1 - x, kControlPoints - 1 - i);
        const double dark = turbidity(at(turbidity.first, 0, i), at(turbidity.first + 1, 0, i));
        const double bright = turbidity(at(turbidity.first, 1, i), at(turbidity.first + 1, 1, i));
        sum += bernstein * (dark + albedo * (bright - dark));
    }
    return sum;
}

}  // namespace

SkyModel::SkyModel(double turbidity, const Spectrum& albedo, double sunElevation) {
    const Between between(turbidity - 1, kTurbidities);
    for (int c = 0; c < 3; ++c) {
        Channel& channel = channels_[size_t(c)];
        for (int i = 0; i < kShapeParameters; ++i)
            channel.shape[size_t(i)] =
                coefficient(kShape, kShapeParameters, c * kShapeParameters + i, between, albedo[c], sunElevation);
        channel.radiance = coefficient(kRadiance, 1, c, between, albedo[c], sunElevation);
    }
}

// Hosek & Wilkie 2012, equations 8 and 9; the data have H last.
Spectrum SkyModel::radiance(double cosTheta, double gamma) const {
    const double cosGamma = std::cos(gamma), rayleigh = cosGamma * cosGamma;
    Spectrum result;
    for (int c = 0; c < 3; ++c) {
        const auto& [a, b, constant, d, e, f, g, i, h] = channels_[size_t(c)].shape;
        const double mie = (1 + rayleigh) / std::pow(1 + h * h - 2 * h * cosGamma, 1.5);
        const double horizon = 1 + a * std::exp(b / (cosTheta + 0.01));
        const double dome = constant + d * std::exp(e * gamma) + f * rayleigh + g * mie + i * std::sqrt(std::max(0.0, cosTheta));
        result[c] = std::max(0.0, horizon * dome * channels_[size_t(c)].radiance);
    }
    return result;
}

Spectrum sunIrradiance(double turbidity, double sunElevation) {
    const Between byTurbidity(turbidity - 1, kTurbidities);
    const Between byElevation((sunElevation * 180 / kPi - 2) / 3, kSunElevations);
    Spectrum result;
    for (int c = 0; c < 3; ++c) {
        const auto at = [&](int t) {
            const float* row = kSunIrradiance + t * kSunElevations * 3 + c;
            return byElevation(double(row[byElevation.first * 3]), double(row[(byElevation.first + 1) * 3]));
        };
        result[c] = std::max(0.0, byTurbidity(at(byTurbidity.first), at(byTurbidity.first + 1)));
    }
    return result;
}

}  // namespace ulam
