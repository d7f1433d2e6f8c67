#include "experiments/statistics/welch.h"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "core/base/error.h"
#include "experiments/statistics/moments.h"

namespace ulam::statistics {
namespace {

double twoSidedP(double t, double degrees) {
    using boost::math::cdf;
    using boost::math::complement;
    if (std::isinf(t)) return 0;
    if (std::isinf(degrees)) return 2 * cdf(complement(boost::math::normal(), std::abs(t)));
    return 2 * cdf(complement(boost::math::students_t(degrees), std::abs(t)));
}

}  // namespace

MeanEstimate estimateMean(std::span<const double> replicates) {
    const auto n = static_cast<double>(replicates.size());
    return {mean(replicates), variance(replicates) / n, n - 1};
}

MeanEstimate combined(const MeanEstimate& a, const MeanEstimate& b) {
    const double na = a.degrees + 1, nb = b.degrees + 1, n = na + nb, difference = b.mean - a.mean;
    const auto squares = [](const MeanEstimate& e) { return e.varianceOfMean * (e.degrees + 1) * e.degrees; };
    const double all = squares(a) + squares(b) + difference * difference * na * nb / n;
    return {a.mean + difference * nb / n, all / (n * (n - 1)), n - 1};
}

double welchDegrees(double varianceA, double degreesA, double varianceB, double degreesB) {
    const double sum = varianceA + varianceB;
    return sum * sum / (varianceA * varianceA / degreesA + varianceB * varianceB / degreesB);
}

double studentQuantile(double degrees, double probability) {
    if (std::isinf(degrees)) return boost::math::quantile(boost::math::normal(), probability);
    return boost::math::quantile(boost::math::students_t(degrees), probability);
}

TTest welchTest(const MeanEstimate& a, const MeanEstimate& b) {
    const double difference = a.mean - b.mean;
    const double varianceOfDifference = a.varianceOfMean + b.varianceOfMean;
    TTest test;
    if (varianceOfDifference == 0) {
        test.degrees = std::numeric_limits<double>::infinity();
        if (difference == 0) return test;
        test.t = std::copysign(std::numeric_limits<double>::infinity(), difference);
    } else {
        test.degrees = welchDegrees(a.varianceOfMean, a.degrees, b.varianceOfMean, b.degrees);
        test.t = difference / std::sqrt(varianceOfDifference);
    }
    test.p = twoSidedP(test.t, test.degrees);
    return test;
}

TTest welchTest(std::span<const double> a, std::span<const double> b) {
    return welchTest(estimateMean(a), estimateMean(b));
}

std::vector<double> welchPValues(std::span<const MeanEstimate> a, std::span<const MeanEstimate> b) {
    if (a.size() != b.size()) {
        fail(ExitCode::InvalidConfig, "Welch test: expected equally many tiles, found {} and {}", a.size(), b.size());
    }
    std::vector<double> p;
    p.reserve(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) p.push_back(welchTest(a[i], b[i]).p);
    return p;
}

}  // namespace ulam::statistics
