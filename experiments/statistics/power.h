#pragma once
// How likely a comparison is to be decided, and what it can detect, from the scatter of its replicates.
//
// The log of a ratio of mean errors is taken as normal with variance `varianceOfLog`, which is estimated with `degrees`
// degrees of freedom, so that the t of a comparison has the noncentral t distribution with noncentrality
// log(ratio) / √varianceOfLog. The permutation test has nearly the power of the t-test it resamples (simulated).

namespace ulam::statistics {

/// Probability that a comparison at this level (two-sided) is decided in the right direction.
double power(double ratio, double varianceOfLog, double degrees, double level);

inline constexpr double kWantedPower = 0.8;

/// The ratio below 1 for which `power` is kWantedPower; its inverse has the same.
double detectableRatio(double varianceOfLog, double degrees, double level);

}  // namespace ulam::statistics
