#include "experiments/statistics/error_spectrum.h"

#include <numbers>
#include <numeric>
#include <vector>

#include "core/base/error.h"
#include "experiments/statistics/moments.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

namespace {

/// Images of errors that a function makes, with their spectrum.
template <class Errors>
ErrorSpectrum spectrumOf(int width, int height, int images, Errors errors, int channels = 1) {
    std::vector<std::vector<double>> values;
    std::vector<ErrorImage> all;
    for (int i = 0; i < images; ++i) values.push_back(errors());
    for (const auto& v : values) all.push_back({v, width, height});
    return errorSpectrum(all, channels);
}

}  // namespace

TEST_CASE("independent errors have a flat spectrum at their variance") {
    PhiloxStream random(61);
    const int width = GENERATE(32, 30);  // a power of two, and not
    const int height = 20, images = 200;
    const ErrorSpectrum s = spectrumOf(width, height, images, [&] {
        std::vector<double> e = normals(std::size_t(width) * std::size_t(height), random);
        for (double& x : e) x *= 0.5;
        return e;
    });
    // A frequency and its negative have one density, exponentially distributed with the variance for standard deviation.
    for (std::size_t b = 0; b < s.mean.size(); ++b) {
        CAPTURE(s.frequencies[b]);
        CHECK(s.mean[b] == Approx(0.25).epsilon(4.5 / std::sqrt(images * s.counts[b] / 2)));
        CHECK(s.low[b] < s.mean[b]);
        CHECK(s.mean[b] < s.high[b]);
    }
    CHECK(s.brightness == Approx(0.25 / (width * height)).epsilon(0.5));
    CHECK(std::ranges::is_sorted(s.frequencies));
    CHECK(s.frequencies.front() == Approx(1.0 / width));
    CHECK(s.frequencies.back() <= std::sqrt(0.5));
}

TEST_CASE("errors that neighbours share lie at low frequencies") {
    PhiloxStream random(62);
    const int size = 32;
    const ErrorSpectrum s = spectrumOf(size, size, 50, [&] {
        const std::vector<double> blocks = normals(16, random);  // of 8 × 8 pixels
        std::vector<double> e;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) e.push_back(blocks[std::size_t(y / 8 * 4 + x / 8)]);
        return e;
    });
    CHECK(s.mean.front() > 20 * s.mean.back());
}

TEST_CASE("a wave shows at its frequency, a brighter image at none") {
    const int width = 48, height = 24;
    const ErrorSpectrum s = spectrumOf(width, height, 1, [&] {
        std::vector<double> e;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) e.push_back(3 + std::sqrt(2.0) * std::cos(2 * std::numbers::pi * 12 * x / width));
        return e;
    });
    CHECK(s.brightness == Approx(9));
    const std::size_t loudest = std::size_t(std::ranges::max_element(s.mean) - s.mean.begin());
    CHECK(s.frequencies[loudest] == Approx(0.25).epsilon(0.15));
    for (std::size_t b = 0; b < s.mean.size(); ++b)
        if (b != loudest) CHECK(s.mean[b] < 1e-12);
}

TEST_CASE("the densities of all frequencies are the mean square") {
    PhiloxStream random(63);
    const int width = 25, height = 14;
    std::vector<double> squares;
    const ErrorSpectrum s = spectrumOf(width, height, 6, [&] {
        std::vector<double> e = lognormalErrors(std::size_t(width * height), 0.5, random);
        squares.push_back(std::inner_product(e.begin(), e.end(), e.begin(), 0.0) / double(e.size()));
        return e;
    }, 3);
    double sum = s.brightness;
    for (std::size_t b = 0; b < s.mean.size(); ++b) sum += s.counts[b] * s.mean[b] / (width * height);
    CHECK(sum == Approx(mean(squares)).epsilon(1e-12));
    CHECK(std::accumulate(s.counts.begin(), s.counts.end(), 0.0) == width * height - 1);
}

TEST_CASE("error images of one run have one size") {
    const std::vector<double> six(6), eight(8);
    CHECK_THROWS_AS(errorSpectrum(std::vector<ErrorImage>{{six, 3, 2}, {eight, 4, 2}}, 1), ulam::Error);
}
