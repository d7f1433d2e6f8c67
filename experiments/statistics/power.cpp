#include "experiments/statistics/power.h"

#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "experiments/statistics/welch.h"

namespace ulam::statistics {
namespace {

double powerOf(double noncentrality, double degrees, double level) {
    const double critical = studentQuantile(degrees, 1 - level / 2);
    return boost::math::cdf(boost::math::complement(boost::math::non_central_t(degrees, noncentrality), critical));
}

}  // namespace

double power(double ratio, double varianceOfLog, double degrees, double level) {
    return powerOf(std::abs(std::log(ratio)) / std::sqrt(varianceOfLog), degrees, level);
}

double detectableRatio(double varianceOfLog, double degrees, double level) {
    // From here the noncentral distribution lies above the critical value nearly as a whole.
    const double highest = 10 * (studentQuantile(degrees, 1 - level / 2) + 1);
    const auto root = boost::math::tools::bisect([&](double d) { return powerOf(d, degrees, level) - kWantedPower; }, 0.0,
                                                 highest, boost::math::tools::eps_tolerance<double>(20));
    return std::exp(-(root.first + root.second) / 2 * std::sqrt(varianceOfLog));
}

}  // namespace ulam::statistics
