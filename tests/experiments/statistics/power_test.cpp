#include "experiments/statistics/power.h"

#include <vector>

#include "experiments/statistics/comparison.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

namespace {

/// What the lognormal errors of both sides make of the log of their ratio.
double varianceOfLog(double sigma, std::size_t replicates) {
    return 2 * (std::exp(sigma * sigma) - 1) / static_cast<double>(replicates);
}

}  // namespace

TEST_CASE("comparisons are decided as often as computed") {
    const auto [replicates, sigma, ratio, trials] = GENERATE(table<std::size_t, double, double, int>(
        {{8, 0.2, 0.75, 1000}, {8, 0.2, 0.85, 1000}, {10, 0.4, 0.6, 100}, {16, 0.3, 0.75, 100}}));
    CAPTURE(replicates, sigma, ratio);
    const double decided = frequency(trials, 91, [&, n = replicates, s = sigma, r = ratio](PhiloxStream& random) {
        std::vector<double> errors = lognormalErrors(n, s, random);
        for (double& e : errors) e *= r;
        std::vector<Comparison> one{compare(errors, lognormalErrors(n, s, random))};
        decide(one);
        return one[0].verdict == Verdict::Better;
    });
    const double computed = power(ratio, varianceOfLog(sigma, replicates), 2 * static_cast<double>(replicates) - 2, 0.05);
    CHECK(computed > 0.3);
    // Four standard deviations, and two points for what is not normal.
    CHECK(decided == Approx(computed).margin(0.02 + 4 * std::sqrt(computed * (1 - computed) / trials)));
}

TEST_CASE("the ratio that can be detected has the power that is wanted") {
    for (const double level : {0.05, 0.05 / 8}) {
        const double ratio = detectableRatio(0.01, 14, level);
        CHECK(ratio < 1);
        CHECK(power(ratio, 0.01, 14, level) == Approx(kWantedPower).epsilon(1e-4));
        CHECK(power(1 / ratio, 0.01, 14, level) == Approx(kWantedPower).epsilon(1e-4));
    }
    CHECK(detectableRatio(0.01, 14, 0.05 / 8) < detectableRatio(0.01, 14, 0.05));
    CHECK(detectableRatio(0.001, 1, 0.001) > 0);
}
