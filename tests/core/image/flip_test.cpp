#include "core/image/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/image/metrics.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

constexpr int kWidth = 64, kHeight = 48;

struct Pair {
    Image image{kWidth, kHeight};
    Image reference{kWidth, kHeight};
};

using Pixel = std::array<double, 3>;

Pixel base(double x, double y) {
    return {0.5 + 0.5 * std::sin(0.15 * x + 0.07 * y), 0.3 + 0.3 * std::cos(0.005 * x * y),
            8 * std::exp(-0.004 * ((x - 30) * (x - 30) + (y - 20) * (y - 20)))};
}

/// Looks random, in [0, 1).
double scatter(double x, double y, int channel) {
    const double v = std::sin(12.9898 * x + 78.233 * y + 37.719 * channel) * 43758.5453;
    return v - std::floor(v);
}

/// The same pairs as in flip_reference.py.
Pair makePair(std::string_view name) {
    Pair pair;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const Pixel here = base(x, y), there = base(x + 2, y);
            for (int c = 0; c < 3; ++c) {
                const double noise = scatter(x, y, c);
                double r = here[c], v = r;
                if (name == "noise") v = r * -std::log(1 - noise);
                if (name == "scaled") v = 1.3 * r;
                if (name == "shifted") v = there[c];
                if (name == "fireflies" && scatter(x, y, 0) < 0.004) v = r + 300;
                if (name == "mostly_black") {
                    r = x < 24 ? r : 0;
                    v = r + 0.02 * noise;
                }
                if (name == "high_range") {
                    r = std::exp(3 * r);
                    v = r * (0.5 + noise);
                }
                if (name == "white_and_black") {
                    r = 5;
                    v = 0;
                }
                pair.reference.at(x, y)[c] = static_cast<float>(r);
                pair.image.at(x, y)[c] = static_cast<float>(v);
            }
        }
    }
    return pair;
}

struct Golden {
    const char* name;
    double mean, start, stop;
    int count;
};

// From flip-evaluator 1.7, NVIDIA's own implementation (BSD-3-Clause), by flip_reference.py.
constexpr Golden kGolden[] = {
    {"noise", 0.470208, 1.225984, 1.938300, 2},
    {"scaled", 0.247908, 1.225984, 1.938300, 2},
    {"shifted", 0.404835, 1.225984, 1.938300, 2},
    {"fireflies", 0.023024, 1.225984, 1.938300, 2},
    {"mostly_black", 0.696171, 1.640894, 24.083298, 23},
    {"high_range", 0.171875, -29.749527, -2.019596, 28},
    {"white_and_black", 0.965196, -1.238631, -1.238631, 2},
};

using Map = std::vector<double>;

Map errorMap(const Image& image, const Image& reference) {
    const Image* const one = &image;
    return flipErrorMaps({&one, 1}, reference).front();
}

}  // namespace

TEST_CASE("HDR-FLIP agrees with NVIDIA's implementation") {
    for (const Golden& golden : kGolden) {
        CAPTURE(golden.name);
        const Pair pair = makePair(golden.name);
        const FlipExposures exposures = flipExposures(pair.reference);
        CHECK(exposures.start == Approx(golden.start).margin(2e-5));
        CHECK(exposures.stop == Approx(golden.stop).margin(2e-5));
        CHECK(exposures.count == golden.count);
        CHECK(findMetric("flip").evaluate(pair.image, pair.reference) == Approx(golden.mean).margin(1e-5));
    }
}

TEST_CASE("HDR-FLIP of an image and itself is zero, and always within [0, 1]") {
    for (const Golden& golden : kGolden) {
        const Pair pair = makePair(golden.name);
        for (const double error : errorMap(pair.reference, pair.reference)) REQUIRE(error == 0);
        for (const double error : errorMap(pair.image, pair.reference)) REQUIRE((error >= 0 && error <= 1));
    }
}

TEST_CASE("HDR-FLIP judges each of many images as if alone") {
    const Pair pair = makePair(kGolden[0].name);
    const Image* const images[] = {&pair.reference, &pair.image, &pair.reference};
    const Map none(pair.reference.pixels.size(), 0.0);
    CHECK(flipErrorMaps(images, pair.reference) == std::vector{none, errorMap(pair.image, pair.reference), none});
}

TEST_CASE("HDR-FLIP is finite for black, negative and enormous images") {
    const Image black(9, 5), negative(9, 5, Rgb(-3)), enormous(9, 5, Rgb(3e38f));
    for (const Image* image : {&black, &negative, &enormous}) {
        for (const Image* reference : {&black, &negative, &enormous}) {
            for (const double error : errorMap(*image, *reference)) REQUIRE((error >= 0 && error <= 1));
        }
    }
    CHECK(errorMap(negative, black) == errorMap(black, black));
    CHECK(errorMap(black, enormous)[0] > 0.9);
}

TEST_CASE("HDR-FLIP marks the place of an error, within the reach of the eye's filters") {
    Image reference(80, 60, Rgb(0.4f)), image = reference;
    image.at(30, 20) = Rgb(2);
    const auto map = errorMap(image, reference);
    const auto errorAt = [&](int x, int y) { return map[static_cast<std::size_t>(y * 80 + x)]; };
    CHECK(errorAt(30, 20) == *std::max_element(map.begin(), map.end()));
    CHECK(errorAt(30, 20) > 0.05);
    CHECK(errorAt(30, 31) < 1e-3);  // both filters end 10 pixels away
    CHECK(errorAt(41, 20) < 1e-3);
}
