#include "experiments/statistics/speedup.h"

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

namespace {

/// scale / seconds at 1, 2, 4, …, 32 s.
Curve inverseCurve(double scale) {
    Curve curve;
    for (double seconds = 1; seconds <= 32; seconds *= 2) curve.push_back({seconds, scale / seconds});
    return curve;
}

std::vector<Curve> noisyCurves(std::size_t n, double sigma, PhiloxStream& random) {
    std::vector<Curve> curves;
    for (double whole : lognormalErrors(n, 0.8 * sigma, random)) {
        Curve curve = inverseCurve(whole);
        const std::vector<double> noise = lognormalErrors(curve.size(), 0.6 * sigma, random);
        for (std::size_t k = 0; k < curve.size(); ++k) curve[k].error *= noise[k];
        curves.push_back(curve);
    }
    return curves;
}

std::vector<CurvePoint> noisyEnds(std::size_t n, CurvePoint expected, double sigma, PhiloxStream& random) {
    std::vector<CurvePoint> ends;
    for (double x : lognormalErrors(n, sigma, random)) ends.push_back({expected.cost, expected.error * x});
    return ends;
}

}  // namespace

TEST_CASE("speed-up is exact on power laws, between snapshots and on them") {
    const std::vector<Curve> baseline(3, inverseCurve(1));
    for (double seconds : {1.0, 1.5, 8.0, 23.0, 32.0}) {
        // A sampler that needs 2 s for what takes the baseline `seconds`.
        const std::vector<CurvePoint> ends(3, {2, 1 / seconds});
        const Speedup s = speedup(ends, baseline);
        CAPTURE(seconds);
        CHECK(s.status == SpeedupStatus::Reached);
        CHECK(*s.value == Approx(seconds / 2));
        CHECK(s.ci95->low == Approx(seconds / 2));
        CHECK(s.ci95->high == Approx(seconds / 2));
    }
}

TEST_CASE("the time is where the mean curve first reaches the error") {
    const Curve bumpy{{1, 1}, {2, 0.25}, {4, 0.5}, {8, 0.125}};
    CHECK(*speedup(std::vector<CurvePoint>{{1, 0.5}}, std::vector<Curve>{bumpy}).value == Approx(std::sqrt(2.0)));
    // The mean of the errors 0.5 and 1.5 counts, not of their logs.
    const std::vector<Curve> two{{{1, 3}, {4, 0.5}}, {{1, 1}, {4, 1.5}}};
    CHECK(*speedup(std::vector<CurvePoint>{{2, 1}}, two).value == Approx(2));
}

TEST_CASE("an error the baseline never reaches gives no value and no upper end") {
    const std::vector<Curve> baseline(4, inverseCurve(1));
    const Speedup s = speedup(std::vector<CurvePoint>(4, {2, 0.01}), baseline);
    CHECK(s.status == SpeedupStatus::NeverReached);
    CHECK_FALSE(s.value);
    CHECK(s.ci95->high == std::numeric_limits<double>::infinity());
}

TEST_CASE("an error the baseline had before its first snapshot gives no value and no lower end") {
    const std::vector<Curve> baseline(4, inverseCurve(1));
    const Speedup s = speedup(std::vector<CurvePoint>(4, {2, 1.5}), baseline);
    CHECK(s.status == SpeedupStatus::BeforeFirstSnapshot);
    CHECK_FALSE(s.value);
    CHECK(s.ci95->low == 0);
}

TEST_CASE("an error the baseline barely reaches leaves the upper end open") {
    PhiloxStream random(51);
    const std::vector<Curve> baseline = noisyCurves(8, 0.4, random);
    const Speedup s = speedup(noisyEnds(8, {2, 1.0 / 25}, 0.4, random), baseline);
    CHECK(s.status == SpeedupStatus::Reached);
    CHECK(s.ci95->low > 4);
    CHECK(s.ci95->low < *s.value);
    CHECK(std::isinf(s.ci95->high));
}

TEST_CASE("the interval of a speed-up covers 93 to 97 %") {
    // 1000 trials, standard error 0.7 %.
    const double truth = 4.5;
    const double coverage = frequency(1000, 52, [&](PhiloxStream& random) {
        const std::vector<Curve> baseline = noisyCurves(8, 0.3, random);
        const Speedup s = speedup(noisyEnds(8, {2, 1 / (2 * truth)}, 0.3, random), baseline);
        return s.ci95->low <= truth && truth <= s.ci95->high;
    });
    CHECK(coverage >= 0.93);
    CHECK(coverage <= 0.97);
}

TEST_CASE("errors at or below zero give no speed-up") {
    std::vector<Curve> baseline(2, inverseCurve(1));
    const Speedup s = speedup(std::vector<CurvePoint>{{1, 0.1}, {1, -0.1}}, baseline);
    CHECK(s.status == SpeedupStatus::ErrorsNotPositive);
    CHECK_FALSE(s.value);
    CHECK_FALSE(s.ci95);
    baseline[1].back().error = 0;
    CHECK(speedup(std::vector<CurvePoint>{{1, 0.1}}, baseline).status == SpeedupStatus::ErrorsNotPositive);
}

TEST_CASE("one replicate has a speed-up without interval; uneven curves are refused") {
    std::vector<Curve> baseline{inverseCurve(1)};
    const std::vector<CurvePoint> ends{{1, 0.25}};
    CHECK(*speedup(ends, baseline).value == Approx(4));
    CHECK_FALSE(speedup(ends, baseline).ci95);
    baseline.push_back({{1, 1}});
    CHECK_THROWS_AS(speedup(ends, baseline), ulam::Error);
    CHECK_THROWS_AS(speedup({}, baseline), ulam::Error);
}
