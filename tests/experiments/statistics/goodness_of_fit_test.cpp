#include "experiments/statistics/goodness_of_fit.h"

#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/error.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

namespace {

/// Counts of `total` draws from cells with the given probabilities.
std::vector<double> draws(std::span<const double> probabilities, int total, PhiloxStream& random) {
    std::discrete_distribution<std::size_t> cells(probabilities.begin(), probabilities.end());
    std::vector<double> counts(probabilities.size());
    for (int i = 0; i < total; ++i) ++counts[cells(random)];
    return counts;
}

}  // namespace

TEST_CASE("the chi-square test matches hand calculation") {
    // 2 degrees of freedom, where p = exp(-statistic / 2).
    const ChiSquareTest test = chiSquareTest(std::vector<double>{8, 12, 10}, std::vector<double>{10, 10, 10});
    CHECK(test.statistic == Approx(0.8));
    CHECK(test.degrees == 2);
    CHECK(test.p == Approx(std::exp(-0.4)));
}

TEST_CASE("small cells are pooled until they hold five") {
    // 1 + 2 + 2 make a cell of five; the cells of 6 and 30 stay alone.
    const ChiSquareTest test = chiSquareTest(std::vector<double>{4, 30, 2, 6, 0}, std::vector<double>{2, 30, 1, 6, 2});
    CHECK(test.degrees == 2);
    CHECK(test.statistic == Approx(0.2));
    CHECK(chiSquareTest(std::vector<double>{1, 2}, std::vector<double>{2, 1}).p == 1);
}

TEST_CASE("an observation where none can be is refused") {
    CHECK(chiSquareTest(std::vector<double>{100, 1}, std::vector<double>{101, 0}).p == 0);
    CHECK(chiSquareTest(std::vector<double>{100, 100, 0}, std::vector<double>{100, 100, 0}).p == 1);
    CHECK_THROWS_AS(chiSquareTest(std::vector<double>{1}, std::vector<double>{1, 2}), ulam::Error);
}

TEST_CASE("the chi-square test keeps its level with sparse cells and sees a wrong density") {
    std::vector<double> truth(50);
    for (std::size_t i = 0; i < truth.size(); ++i) truth[i] = std::pow(0.9, static_cast<double>(i));
    const double sum = std::accumulate(truth.begin(), truth.end(), 0.0);
    std::vector<double> expected = truth;
    for (double& x : expected) x *= 1000 / sum;
    std::vector<double> wrong = truth;
    for (std::size_t i = 0; i < 10; i += 2) wrong[i] *= 1.6;
    const auto rejected = [&](std::span<const double> sampled, std::uint64_t seed) {
        return frequency(2000, seed, [&](PhiloxStream& random) {
            return chiSquareTest(draws(sampled, 1000, random), expected).p <= 0.05;
        });
    };
    CHECK(rejected(truth, 81) == Approx(0.05).margin(0.015));  // standard error 0.5 %
    CHECK(rejected(wrong, 82) >= 0.8);
}

TEST_CASE("the distance of Kolmogorov and Smirnov by hand") {
    CHECK(uniformityTest(std::vector<double>{0.7, 0.1, 0.4}).distance == Approx(0.3));
    CHECK(uniformityTest(std::vector<double>{0.5}).distance == Approx(0.5));
    CHECK(uniformityTest({}).p == 1);
}

TEST_CASE("the uniformity test keeps its level and sees a wrong p-value") {
    std::uniform_real_distribution<double> uniform;
    const int n = GENERATE(10, 100);
    CAPTURE(n);
    const auto rejected = [&](double power, std::uint64_t seed) {
        return frequency(10'000, seed, [&](PhiloxStream& random) {
            std::vector<double> p(static_cast<std::size_t>(n));
            std::ranges::generate(p, [&] { return std::pow(uniform(random), power); });
            return uniformityTest(p).p <= 0.05;
        });
    };
    CHECK(rejected(1, 83) == Approx(0.05).margin(0.008));  // standard error 0.2 %
    CHECK(rejected(3, 84) >= 0.7);
}
