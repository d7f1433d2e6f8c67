#include "core/image/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image/srgb.h"

namespace ulam {
namespace {

using Field = std::vector<double>;

Field shownLuminance(const Image& image) {
    Field plane;
    plane.reserve(image.pixels.size());
    for (const Rgb& p : image.pixels) plane.push_back(linearToSrgb(std::clamp(luminance(Spectrum(p)), 0.0, 1.0)));
    return plane;
}

std::array<double, 2 * kSsimRadius + 1> windowWeights() {
    std::array<double, 2 * kSsimRadius + 1> weights;
    for (int i = -kSsimRadius; i <= kSsimRadius; ++i) {
        weights[i + kSsimRadius] = std::exp(-i * i / (2 * kSsimSigma * kSsimSigma));
    }
    return weights;
}

/// Weighted means along `count` lines of `length` pixels that lie `stride` apart; lines start `lineStride` apart.
Field average(const Field& in, int count, int lineStride, int length, int stride) {
    static const auto weights = windowWeights();
    Field out(in.size());
    for (int line = 0; line < count; ++line) {
        const std::size_t start = static_cast<std::size_t>(line) * lineStride;
        for (int i = 0; i < length; ++i) {
            double sum = 0, total = 0;
            for (int j = std::max(0, i - kSsimRadius); j <= std::min(length - 1, i + kSsimRadius); ++j) {
                const double weight = weights[j - i + kSsimRadius];
                sum += weight * in[start + static_cast<std::size_t>(j) * stride];
                total += weight;
            }
            out[start + static_cast<std::size_t>(i) * stride] = sum / total;
        }
    }
    return out;
}

}  // namespace

std::vector<double> ssimErrorMap(const Image& image, const Image& reference) {
    const int width = image.width, height = image.height;
    const auto smooth = [&](const Field& in) {
        return average(average(in, height, width, width, 1), width, 1, height, width);
    };
    const auto product = [](const Field& a, const Field& b) {
        Field result(a.size());
        std::transform(a.begin(), a.end(), b.begin(), result.begin(), std::multiplies<>());
        return result;
    };
    const Field x = shownLuminance(image), y = shownLuminance(reference);
    const Field meanX = smooth(x), meanY = smooth(y);
    const Field meanXX = smooth(product(x, x)), meanYY = smooth(product(y, y)), meanXY = smooth(product(x, y));

    constexpr double c1 = kSsimK1 * kSsimK1, c2 = kSsimK2 * kSsimK2;
    Field error(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double mx = meanX[i], my = meanY[i];
        const double varX = meanXX[i] - mx * mx, varY = meanYY[i] - my * my, cov = meanXY[i] - mx * my;
        error[i] = 1 - (2 * mx * my + c1) * (2 * cov + c2) / ((mx * mx + my * my + c1) * (varX + varY + c2));
    }
    return error;
}

}  // namespace ulam
