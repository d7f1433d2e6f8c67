#include "experiments/statistics/welch.h"

#include <vector>

#include "core/base/error.h"
#include "experiments/statistics/holm.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

TEST_CASE("Welch's test matches hand calculation") {
    // Means 2.5 and 6, variances of the mean 5/12 and 10/4: t = -3.5 / sqrt(35/12).
    const TTest test = welchTest(std::vector<double>{1, 2, 3, 4}, std::vector<double>{2, 6, 6, 10});
    const double va = 5.0 / 12;
    const double vb = (32.0 / 3) / 4;
    CHECK(test.t == Approx(-3.5 / std::sqrt(va + vb)));
    CHECK(test.degrees == Approx((va + vb) * (va + vb) / (va * va / 3 + vb * vb / 3)));
    // One sample against 0: t = 2 / sqrt(1/3), 2 degrees of freedom, where p = 1 - t / sqrt(t^2 + 2).
    const TTest one = welchTest(estimateMean(std::vector<double>{1, 2, 3}), MeanEstimate{0});
    CHECK(one.degrees == Approx(2));
    CHECK(one.p == Approx(1 - std::sqrt(12.0 / 14)));
}

TEST_CASE("t quantiles match tables") {
    CHECK(studentQuantile(7, 0.975) == Approx(2.364624).epsilon(1e-6));
    CHECK(studentQuantile(std::numeric_limits<double>::infinity(), 0.975) == Approx(1.959964).epsilon(1e-6));
}

TEST_CASE("estimates without variance are equal or different") {
    CHECK(welchTest(MeanEstimate{1}, MeanEstimate{1}).p == 1);
    CHECK(welchTest(MeanEstimate{1}, MeanEstimate{2}).p == 0);
    const std::vector<double> same{2, 2, 2};
    CHECK(welchTest(same, same).p == 1);
    CHECK(welchTest(same, std::vector<double>{3, 3, 3}).p == 0);
    // A constant sample against an uncertain reference: the reference's variance decides.
    CHECK(welchTest(estimateMean(same), MeanEstimate{2.1, 0.01}).p == Approx(0.31731).epsilon(1e-4));
}

TEST_CASE("the level holds for unequal variances and sizes") {
    const double rejected = frequency(20'000, 71, [](PhiloxStream& random) {
        std::vector<double> a = normals(6, random);
        for (double& x : a) x *= 5;
        return welchTest(a, normals(20, random)).p <= 0.05;
    });
    CHECK(rejected == Approx(0.05).margin(0.006));  // standard error 0.15 %
}

TEST_CASE("one wrong tile among 256 is found and right ones are not") {
    const auto tiles = [](PhiloxStream& random, double shift) {
        std::vector<MeanEstimate> result;
        for (int i = 0; i < 256; ++i) {
            std::vector<double> replicates = normals(32, random);
            if (i == 100) {
                for (double& x : replicates) x += shift;
            }
            result.push_back(estimateMean(replicates));
        }
        return result;
    };
    const auto smallest = [&](PhiloxStream& random, double shift) {
        const std::vector<MeanEstimate> a = tiles(random, 0);
        return std::ranges::min(holmAdjusted(welchPValues(a, tiles(random, shift))));
    };
    const double falseAlarms = frequency(500, 72, [&](PhiloxStream& r) { return smallest(r, 0) <= 0.05; });
    const double found = frequency(100, 73, [&](PhiloxStream& r) { return smallest(r, 2) <= 0.05; });
    CHECK(falseAlarms <= 0.08);  // 5 % and three standard errors
    CHECK(found >= 0.99);
    CHECK_THROWS_AS(welchPValues(std::vector<MeanEstimate>(2), std::vector<MeanEstimate>(3)), ulam::Error);
}

TEST_CASE("two groups together are one group") {
    const std::vector<double> x{1, 4, 2, 8, 5, 7};
    const std::span<const double> all(x);
    for (const std::size_t n : {std::size_t(2), std::size_t(4)}) {
        const MeanEstimate whole = estimateMean(all);
        const MeanEstimate both = combined(estimateMean(all.first(n)), estimateMean(all.subspan(n)));
        CHECK(both.mean == Approx(whole.mean));
        CHECK(both.varianceOfMean == Approx(whole.varianceOfMean));
        CHECK(both.degrees == whole.degrees);
    }
    const MeanEstimate one{3, 0, 0};
    CHECK(combined(one, {5, 0, 0}).varianceOfMean == Approx(1));
}
