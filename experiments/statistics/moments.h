#pragma once
// Moments and order statistics of a handful of replicates or of all pixels of an error image.
// Empty input has no mean and fewer than two values have no variance: both come back as NaN.

#include <span>

namespace ulam::statistics {

double mean(std::span<const double> values);

/// Unbiased: divided by n - 1.
double variance(std::span<const double> values);

/// Standard deviation over |mean|.
double coefficientOfVariation(std::span<const double> values);

inline constexpr double kTrimmedFraction = 0.001;

/// Mean without the largest floor(fraction * n) values. One-sided because errors have their outliers (fireflies) at
/// the top only; the distance to the untrimmed mean is the share of the error those pixels carry.
double trimmedMean(std::span<const double> values, double fraction = kTrimmedFraction);

/// Linear interpolation between order statistics, q in [0, 1] (type 7 of Hyndman & Fan 1996, "Sample quantiles in
/// statistical packages"). Infinite values are allowed. `sorted` ascends.
double quantileOfSorted(std::span<const double> sorted, double q);
double quantile(std::span<const double> values, double q);

}  // namespace ulam::statistics
