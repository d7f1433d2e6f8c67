#include "experiments/statistics/moments.h"

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/catch.h"

using namespace ulam::statistics;

TEST_CASE("moments of a small sample match hand calculation") {
    const std::vector<double> x{2, 4, 4, 4, 5, 5, 7, 9};
    CHECK(mean(x) == Approx(5));
    CHECK(variance(x) == Approx(32.0 / 7));
    CHECK(coefficientOfVariation(x) == Approx(std::sqrt(32.0 / 7) / 5));
}

TEST_CASE("mean and variance without enough values are NaN") {
    CHECK(std::isnan(mean({})));
    CHECK(std::isnan(variance(std::vector<double>{1.0})));
}

TEST_CASE("quantiles interpolate between order statistics") {
    const std::vector<double> x{4, 1, 3, 2};
    CHECK(quantile(x, 0) == 1);
    CHECK(quantile(x, 1) == 4);
    CHECK(quantile(x, 0.5) == Approx(2.5));
    CHECK(quantile(x, 0.25) == Approx(1.75));
}

TEST_CASE("quantiles of samples with infinite values are never NaN") {
    const double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> x{1, 2, infinity, infinity};
    CHECK(quantile(x, 0.2) == Approx(1.6));
    CHECK(quantile(x, 0.5) == infinity);
    CHECK(quantile(x, 0.9) == infinity);
}

TEST_CASE("the trimmed mean leaves out the largest thousandth") {
    std::vector<double> x(2000, 1.0);
    x[17] = 1e6;
    x[1234] = 1e7;
    CHECK(trimmedMean(x) == Approx(1));
    x[3] = 2001 - 1998;
    CHECK(trimmedMean(x) == Approx((1997 + 3) / 1998.0));
    CHECK(trimmedMean(std::vector<double>{1, 2, 9}) == Approx(4));
}
