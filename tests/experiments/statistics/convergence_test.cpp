#include "experiments/statistics/convergence.h"

#include <cmath>
#include <vector>

#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

namespace {

std::vector<Curve> curves(std::size_t replicates, double slope, double sigma, PhiloxStream& random) {
    std::vector<Curve> result(replicates);
    for (Curve& curve : result) {
        const std::vector<double> noise = lognormalErrors(6, sigma, random);
        for (std::size_t k = 0; k < noise.size(); ++k) {
            const double cost = std::exp2(static_cast<double>(k));
            curve.push_back({cost, 3 * std::pow(cost, slope) * noise[k]});
        }
    }
    return result;
}

}  // namespace

TEST_CASE("the slope of a power law is its exponent") {
    PhiloxStream random(61);
    const Slope steep = *fitSlope(curves(3, -1, 0, random));
    CHECK(steep.slope == Approx(-1));
    CHECK_FALSE(fitSlope(curves(1, -0.5, 0, random))->ci95);
    const Slope flat = *fitSlope(curves(3, -0.5, 0.01, random));
    CHECK(flat.slope == Approx(-0.5).epsilon(0.02));
    CHECK(flat.flatter);
}

TEST_CASE("the interval of a slope covers 95 % and flags 2.5 % of unbiased samplers as flat") {
    int covered = 0;
    int flagged = 0;
    const int trials = 10'000;
    PhiloxStream random(62);
    for (int i = 0; i < trials; ++i) {
        const Slope s = *fitSlope(curves(8, -1, 0.3, random));
        covered += s.ci95->low <= -1 && -1 <= s.ci95->high;
        flagged += s.flatter;
    }
    CHECK(covered / double(trials) == Approx(0.95).margin(0.01));  // standard error 0.2 %
    CHECK(flagged / double(trials) == Approx(0.025).margin(0.006));
}

TEST_CASE("a slope of -0.8 is found flat") {
    const double power =
        frequency(1000, 63, [](PhiloxStream& random) { return fitSlope(curves(8, -0.8, 0.3, random))->flatter; });
    CHECK(power >= 0.95);
}

TEST_CASE("curves without a slope have none") {
    CHECK_FALSE(fitSlope({}));
    CHECK_FALSE(fitSlope(std::vector<Curve>{{{1, 2}}}));
    CHECK_FALSE(fitSlope(std::vector<Curve>{{{1, 2}, {1, 3}}}));
    CHECK_FALSE(fitSlope(std::vector<Curve>{{{1, 2}, {2, -1}}}));
}
