#include "experiments/statistics/speedup.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/base/error.h"
#include "experiments/statistics/moments.h"

namespace ulam::statistics {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kBeforeFirst = 0;

using Indices = std::span<const std::size_t>;

CurvePoint meanEnd(std::span<const CurvePoint> ends, Indices chosen) {
    CurvePoint sum;
    for (std::size_t i : chosen) {
        sum.cost += ends[i].cost;
        sum.error += ends[i].error;
    }
    const auto n = static_cast<double>(chosen.size());
    return {sum.cost / n, sum.error / n};
}

Curve meanCurve(std::span<const Curve> curves, Indices chosen) {
    Curve result(curves.front().size());
    const auto n = static_cast<double>(chosen.size());
    for (std::size_t k = 0; k < result.size(); ++k) {
        for (std::size_t i : chosen) {
            result[k].cost += curves[i][k].cost / n;
            result[k].error += curves[i][k].error / n;
        }
    }
    return result;
}

double costToReach(const Curve& curve, double error) {
    if (curve.front().error < error) return kBeforeFirst;
    for (std::size_t k = 0; k < curve.size(); ++k) {
        if (curve[k].error > error) continue;
        if (k == 0) return curve[k].cost;
        const CurvePoint& before = curve[k - 1];
        const double fraction = std::log(before.error / error) / std::log(before.error / curve[k].error);
        return before.cost * std::pow(curve[k].cost / before.cost, fraction);
    }
    return kNever;
}

/// In [0, ∞]; the two ends stand for kBeforeFirst and kNever.
double extendedSpeedup(std::span<const CurvePoint> samplerEnds, Indices chosenEnds, std::span<const Curve> baseline,
                       Indices chosenCurves) {
    const CurvePoint end = meanEnd(samplerEnds, chosenEnds);
    return costToReach(meanCurve(baseline, chosenCurves), end.error) / end.cost;
}

std::vector<std::size_t> identity(std::size_t n) {
    std::vector<std::size_t> indices(n);
    std::iota(indices.begin(), indices.end(), std::size_t{0});
    return indices;
}

void redraw(std::vector<std::size_t>& indices, PhiloxStream& random) {
    for (std::size_t& i : indices) i = random.index(indices.size());
}

bool errorsPositive(std::span<const CurvePoint> points) {
    return std::ranges::all_of(points, [](const CurvePoint& p) { return p.error > 0; });
}

}  // namespace

Speedup speedup(std::span<const CurvePoint> samplerEnds, std::span<const Curve> baseline, const Design& design) {
    if (samplerEnds.empty() || baseline.empty() || baseline.front().empty()) {
        fail(ExitCode::InvalidConfig, "speed-up: expected at least one replicate and one snapshot on each side");
    }
    for (const Curve& curve : baseline) {
        if (curve.size() == baseline.front().size()) continue;
        fail(ExitCode::InvalidConfig, "speed-up: expected {} snapshots in every replicate of the baseline, found {}",
             baseline.front().size(), curve.size());
    }
    if (design.paired && samplerEnds.size() != baseline.size()) {
        fail(ExitCode::InvalidConfig, "speed-up: expected as many replicates on both sides, found {} and {}",
             samplerEnds.size(), baseline.size());
    }
    Speedup result;
    if (!errorsPositive(samplerEnds) || !std::ranges::all_of(baseline, errorsPositive)) {
        result.status = SpeedupStatus::ErrorsNotPositive;
        return result;
    }
    std::vector<std::size_t> ends = identity(samplerEnds.size());
    std::vector<std::size_t> curves = identity(baseline.size());
    const double value = extendedSpeedup(samplerEnds, ends, baseline, curves);
    if (value == kNever) {
        result.status = SpeedupStatus::NeverReached;
    } else if (value == kBeforeFirst) {
        result.status = SpeedupStatus::BeforeFirstSnapshot;
    } else {
        result.value = value;
    }
    const std::size_t smaller = std::min(ends.size(), curves.size());
    if (smaller < 2) return result;

    PhiloxStream random(kResamplingSeed);
    std::vector<double> draws(kBootstrapResamples);
    for (double& draw : draws) {
        redraw(ends, random);
        if (design.paired)
            curves = ends;
        else
            redraw(curves, random);
        draw = extendedSpeedup(samplerEnds, ends, baseline, curves);
    }
    const double tail = bootstrapTail(smaller, design.confidence());
    result.ci95 = Interval{quantile(draws, tail), quantile(draws, 1 - tail)};
    return result;
}

}  // namespace ulam::statistics
