#include "experiments/report/picture_code.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/image/image_io.h"

namespace ulam {
namespace {

constexpr int kMantissaBits = 9;
constexpr int kBias = 15;
constexpr float kLargest = 65408;  // 511 · 2^(31 − 24)

constexpr double kWhiteOverToe = 64;
constexpr double kLargestOverWhite = 256;

/// The 99th percentile of the pixels' largest channels and the largest of all; that one twice where the first is 0.
std::pair<double, double> whiteAndLargest(const Image& image) {
    std::vector<float> values;
    for (const Rgb& pixel : image.pixels) values.push_back(std::max({pixel.x, pixel.y, pixel.z, 0.0f}));
    const auto white = values.begin() + std::ptrdiff_t(0.99 * double(values.size() - 1));
    std::nth_element(values.begin(), white, values.end());
    const double largest = *std::max_element(white, values.end());
    return {*white > 0 ? *white : largest, largest};
}

uint32_t encodePixel(const Rgb& rgb) {
    const auto legal = [](float v) { return v > 0 ? std::min(v, kLargest) : 0.0f; };
    const float r = legal(rgb.x), g = legal(rgb.y), b = legal(rgb.z);
    const float most = std::max({r, g, b});
    int exponent = most > 0 ? std::max(-kBias - 1, std::ilogb(most)) + 1 + kBias : 0;
    const auto mantissa = [&](float v) {
        return static_cast<uint32_t>(std::lround(std::ldexp(v, kBias + kMantissaBits - exponent)));
    };
    if (mantissa(most) == 1u << kMantissaBits) ++exponent;  // rounded up to a power of two
    return mantissa(r) | mantissa(g) << 9 | mantissa(b) << 18 | static_cast<uint32_t>(exponent) << 27;
}

}  // namespace

std::string encodeRgb9e5(const Image& image) {
    std::string bytes;
    bytes.reserve(4 * image.pixels.size());
    for (const Rgb& pixel : image.pixels) {
        const uint32_t word = encodePixel(pixel);
        for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(word >> shift & 255));
    }
    return bytes;
}

JpegPicture encodeJpegPicture(const Image& image, int quality) {
    const auto [white, largest] = whiteAndLargest(image);
    JpegPicture picture;
    std::vector<std::uint8_t> codes(3 * image.pixels.size());
    if (largest > 0) {
        picture.toe = white / kWhiteOverToe;
        picture.step = std::asinh(std::min(largest, kLargestOverWhite * white) / picture.toe) / 255;
        auto code = codes.begin();
        for (const Rgb& pixel : image.pixels)
            for (int c = 0; c < 3; ++c)
                *code++ = std::uint8_t(
                    std::lround(std::clamp(std::asinh(pixel[c] / picture.toe) / picture.step, 0.0, 255.0)));
    }
    picture.bytes = encodeJpeg(codes, image.width, image.height, quality);
    return picture;
}

std::string encodeBase64(std::string_view bytes) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
        uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? static_cast<uint8_t>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text.push_back(k <= n ? kDigits[group >> (18 - 6 * k) & 63] : '=');
    }
    return text;
}

Image shrink(const Image& image, int factor) {
    if (factor == 1) return image;
    Image small((image.width + factor - 1) / factor, (image.height + factor - 1) / factor);
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            const int right = std::min(image.width, (x + 1) * factor),
                      bottom = std::min(image.height, (y + 1) * factor);
            Spectrum total(0);
            for (int v = y * factor; v < bottom; ++v)
                for (int u = x * factor; u < right; ++u) total += Spectrum(image.at(u, v));
            const double pixels = double(right - x * factor) * double(bottom - y * factor);
            small.at(x, y) = Rgb(total / pixels);
        }
    }
    return small;
}

}  // namespace ulam
