#include "core/base/kronecker.h"

#include "core/base/random.h"
#include "tests/support/chi_square.h"

#include <algorithm>
#include <cmath>

using namespace ulam;

TEST_CASE("one dimension steps by the golden ratio, two by the plastic number") {
    const KroneckerSequence<1> golden({0.25});
    const KroneckerSequence<2> plastic({0.25, 0.5});
    const double phi = (1 + std::sqrt(5)) / 2;
    const double rho = 1.32471795724474602596;  // ρ³ = ρ + 1
    for (const uint64_t i : {0ull, 1ull, 2ull, 1000ull, 20'000'000ull}) {
        auto fraction = [](long double x) { return double(x - std::floor(x)); };
        CHECK(golden(i, 0) == Approx(fraction(0.25L + i / (long double)phi)).margin(1e-8));
        CHECK(plastic(i, 0) == Approx(fraction(0.25L + i / (long double)rho)).margin(1e-8));
        CHECK(plastic(i, 1) == Approx(fraction(0.5L + i / ((long double)rho * rho))).margin(1e-8));
    }
}

TEST_CASE("points of a Kronecker sequence are even in every dimension, and in the first two together") {
    constexpr int kPoints = 4096, kCells = 64;
    constexpr double kMean = double(kPoints) / kCells;
    const KroneckerSequence<7> points;
    auto scatter = [&](const auto& cell) {
        std::array<double, kCells> counts{};
        for (uint64_t i = 0; i < kPoints; ++i) ++counts[size_t(cell(i))];
        double squares = 0;
        for (const double c : counts) squares += (c - kMean) * (c - kMean);
        return std::sqrt(squares / kCells);
    };
    // Independent points scatter by √64 = 8.
    for (int k = 0; k < 7; ++k) {
        INFO(k);
        CHECK(scatter([&](uint64_t i) { return int(points(i, k) * kCells); }) < 4);
    }
    CHECK(scatter([&](uint64_t i) { return int(points(i, 0) * 8) * 8 + int(points(i, 1) * 8); }) < 4);
}

TEST_CASE("a shifted point is uniform") {
    std::vector<double> counts(100), flat(100, 0.01);
    for (uint64_t i = 0; i < 100'000; ++i) {
        Random random(makeKey(3), 0, i);
        ++counts[size_t(KroneckerSequence<1>({random()})(17, 0) * 100)];
    }
    CHECK_FIT(misfit(counts, flat));
}
