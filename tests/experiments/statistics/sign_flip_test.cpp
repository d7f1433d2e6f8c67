#include "experiments/statistics/sign_flip.h"

#include "experiments/statistics/permutation.h"

#include <vector>

#include "core/base/error.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

TEST_CASE("signs that make the sum of differences as large are counted") {
    // Differences 1, 2, 4: of the sums ±7, ±5, ±3, ±1 two are as far from 0 as 7.
    CHECK(signFlipP(std::vector<double>{2, 4, 8}, std::vector<double>{1, 2, 4}) == Approx(2.0 / 8));
    // -1, 2, 4: ±7 and ±5.
    CHECK(signFlipP(std::vector<double>{1, 4, 8}, std::vector<double>{2, 2, 4}) == Approx(4.0 / 8));
    CHECK(signFlipP(std::vector<double>{1, 2}, std::vector<double>{1, 2}) == 1);
    const std::vector<double> low(8, 1.0), high(8, 2.0);
    CHECK(signFlipP(low, high) == Approx(2.0 / 256));
    CHECK(signFlipP(low, high) == Approx(smallestSignFlipP(8)));
    CHECK(signFlipP(high, low) == signFlipP(low, high));
}

TEST_CASE("beyond all signs random ones give the same p") {
    CHECK(smallestSignFlipP(17) == Approx(2.0 / 131072));
    CHECK(smallestSignFlipP(18) == Approx(1e-5));
    PhiloxStream random(81);
    std::vector<double> a = lognormalErrors(17, 0.3, random), b = lognormalErrors(17, 0.3, random);
    const double exact = signFlipP(a, b);
    // A pair without a difference changes no sum.
    a.push_back(1), b.push_back(1);
    CHECK(signFlipP(a, b) == Approx(exact).margin(4 * std::sqrt(exact / kRandomSplits)));
}

TEST_CASE("pairs that go together are told apart where groups are not") {
    PhiloxStream random(82);
    const auto pairs = [&](double ratio) {
        const std::vector<double> shared = lognormalErrors(8, 0.5, random), a = lognormalErrors(8, 0.05, random),
                                  b = lognormalErrors(8, 0.05, random);
        std::pair<std::vector<double>, std::vector<double>> errors;
        for (std::size_t i = 0; i < shared.size(); ++i) {
            errors.first.push_back(ratio * shared[i] * a[i]);
            errors.second.push_back(shared[i] * b[i]);
        }
        return errors;
    };
    int found = 0, alarms = 0, unpaired = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto [a, b] = pairs(0.8);
        found += signFlipP(a, b) <= 0.05;
        unpaired += permutationP(a, b) <= 0.05;
        const auto [x, y] = pairs(1);
        alarms += signFlipP(x, y) <= 0.05;
    }
    CHECK(found > 1900);
    CHECK(unpaired < 400);
    CHECK(alarms <= 130);  // 6.5 %: 100 expected, standard deviation 10
    CHECK(alarms >= 20);
}

TEST_CASE("pairs need partners") {
    CHECK_THROWS_AS(signFlipP(std::vector<double>{1, 2}, std::vector<double>{1}), ulam::Error);
    CHECK_THROWS_AS(signFlipP(std::vector<double>{}, std::vector<double>{}), ulam::Error);
}
