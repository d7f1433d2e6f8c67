#pragma once
// Welch's t-test (Welch 1947, "The generalization of 'Student's' problem when several different population variances
// are involved"). One type, MeanEstimate, serves a group of replicates, a reference with its own variance and an exact
// truth, so that the one-sample and the two-sample test are the same function.

#include <limits>
#include <span>
#include <vector>

namespace ulam::statistics {

struct MeanEstimate {
    double mean = 0;
    double varianceOfMean = 0;  // 0 for an exact truth
    double degrees = std::numeric_limits<double>::infinity();
};

/// Of independent replicates: s^2 / n with n - 1 degrees of freedom. Needs at least two values.
MeanEstimate estimateMean(std::span<const double> replicates);

/// Of two groups of replicates as of one (Chan, Golub and LeVeque 1983, "Algorithms for Computing the Sample Variance"). The
/// degrees of freedom of each are its number less one.
MeanEstimate combined(const MeanEstimate& a, const MeanEstimate& b);

/// Welch–Satterthwaite degrees of freedom of the sum of two independent variances of means.
double welchDegrees(double varianceA, double degreesA, double varianceB, double degreesB);

/// Quantile of Student's t; infinite degrees of freedom give the normal distribution.
double studentQuantile(double degrees, double probability);

struct TTest {
    double t = 0;
    double degrees = 0;
    double p = 1;  // two-sided
};

/// Two estimates without any variance are equal (p = 1) or different (p = 0).
TTest welchTest(const MeanEstimate& a, const MeanEstimate& b);
TTest welchTest(std::span<const double> a, std::span<const double> b);

/// One p-value per tile; correct them with holmAdjusted or sidakAdjusted. Throws on different numbers of tiles.
std::vector<double> welchPValues(std::span<const MeanEstimate> a, std::span<const MeanEstimate> b);

}  // namespace ulam::statistics
