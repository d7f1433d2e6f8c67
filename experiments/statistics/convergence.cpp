#include "experiments/statistics/convergence.h"

#include <cmath>
#include <vector>

#include "experiments/statistics/moments.h"

namespace ulam::statistics {
namespace {

constexpr double kUnbiasedSlope = -1;

std::optional<double> leastSquaresSlope(const Curve& curve) {
    std::vector<double> x;
    std::vector<double> y;
    for (const CurvePoint& point : curve) {
        if (!(point.error > 0)) return std::nullopt;
        x.push_back(std::log(point.cost));
        y.push_back(std::log(point.error));
    }
    const double meanX = mean(x);
    const double meanY = mean(y);
    double xx = 0;
    double xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - meanX) * (x[i] - meanX);
        xy += (x[i] - meanX) * (y[i] - meanY);
    }
    if (!(xx > 0)) return std::nullopt;
    return xy / xx;
}

}  // namespace

std::optional<Slope> fitSlope(std::span<const Curve> replicates) {
    std::vector<double> slopes;
    for (const Curve& curve : replicates) {
        const std::optional<double> slope = leastSquaresSlope(curve);
        if (!slope) return std::nullopt;
        slopes.push_back(*slope);
    }
    if (slopes.empty()) return std::nullopt;
    Slope result{mean(slopes), studentInterval(slopes), false};
    result.flatter = result.ci95 && result.ci95->low > kUnbiasedSlope;
    return result;
}

}  // namespace ulam::statistics
