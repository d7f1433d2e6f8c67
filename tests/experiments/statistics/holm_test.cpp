#include "experiments/statistics/holm.h"

#include <cmath>
#include <vector>

#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;

TEST_CASE("Holm matches a hand example and keeps the order of the input") {
    // Sorted: 0.005 * 4, 0.01 * 3, 0.03 * 2, then 0.04 * 1 raised to its predecessor.
    const std::vector<double> adjusted = holmAdjusted(std::vector<double>{0.01, 0.04, 0.03, 0.005});
    REQUIRE(adjusted.size() == 4);
    CHECK(adjusted[0] == Approx(0.03));
    CHECK(adjusted[1] == Approx(0.06));
    CHECK(adjusted[2] == Approx(0.06));
    CHECK(adjusted[3] == Approx(0.02));
}

TEST_CASE("adjusted p-values never exceed 1 and one test needs no correction") {
    CHECK(holmAdjusted(std::vector<double>{0.6, 0.9}) == std::vector<double>{1, 1});
    CHECK(holmAdjusted(std::vector<double>{0.04}) == std::vector<double>{0.04});
    CHECK(holmAdjusted({}).empty());
    CHECK(sidakAdjusted(std::vector<double>{0.04})[0] == Approx(0.04));
}

TEST_CASE("Šidák is exact for independent tests and precise for tiny p") {
    CHECK(sidakAdjusted(std::vector<double>{0.05, 0.5, 1})[0] == Approx(1 - std::pow(0.95, 3)));
    CHECK(sidakAdjusted(std::vector<double>{0.05, 0.5, 1})[2] == 1);
    CHECK(sidakAdjusted(std::vector<double>(1000, 1e-20))[0] == Approx(1e-17));
}

TEST_CASE("both corrections keep the family-wise level of 20 independent tests") {
    std::uniform_real_distribution<double> uniform;
    std::vector<double> p(20);
    const auto anyBelow = [&](auto adjust) {
        return simulation::frequency(20'000, 31, [&](PhiloxStream& random) {
            for (double& x : p) x = uniform(random);
            return std::ranges::min(adjust(p)) <= 0.05;
        });
    };
    // Standard error 0.15 %; the exact rates are 1 - (1 - 0.05/20)^20 = 4.88 % and 5 %.
    CHECK(anyBelow(holmAdjusted) == Approx(0.0488).margin(0.005));
    CHECK(anyBelow(sidakAdjusted) == Approx(0.05).margin(0.005));
}

TEST_CASE("Benjamini and Hochberg's adjustment matches a hand example") {
    // Sorted: 0.005 * 4/1, 0.01 * 4/2, 0.03 * 4/3, 0.04 * 4/4, each lowered to its successor.
    const std::vector<double> adjusted = benjaminiHochbergAdjusted(std::vector<double>{0.01, 0.04, 0.03, 0.005});
    REQUIRE(adjusted.size() == 4);
    CHECK(adjusted[0] == Approx(0.02));
    CHECK(adjusted[1] == Approx(0.04));
    CHECK(adjusted[2] == Approx(0.04));
    CHECK(adjusted[3] == Approx(0.02));
    CHECK(benjaminiHochbergAdjusted({}).empty());
    CHECK(benjaminiHochbergAdjusted(std::vector<double>{0.6, 0.9}) == std::vector<double>{0.9, 0.9});
}

TEST_CASE("of the discoveries at a false discovery rate of 5 % a share of 5 % times that of true hypotheses is false") {
    std::uniform_real_distribution<double> uniform;
    PhiloxStream random(32);
    double share = 0;
    constexpr int kTrials = 2000, kTests = 200, kTrue = 150;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<double> p(kTests);
        for (int i = 0; i < kTests; ++i) p[std::size_t(i)] = uniform(random) * (i < kTrue ? 1 : 1e-3);
        int found = 0, wrong = 0;
        const std::vector<double> adjusted = benjaminiHochbergAdjusted(p);
        for (int i = 0; i < kTests; ++i) {
            if (adjusted[std::size_t(i)] > 0.05) continue;
            ++found;
            wrong += i < kTrue;
        }
        if (found > 0) share += double(wrong) / found / kTrials;
    }
    CHECK(share == Approx(0.05 * kTrue / kTests).margin(0.003));  // standard error 0.06 %
}
