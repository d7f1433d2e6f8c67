#pragma once
// Does a sample follow its distribution?

#include <span>

namespace ulam::statistics {

struct ChiSquareTest {
    double statistic = 0;
    double degrees = 0;
    double p = 1;
};

inline constexpr double kSmallestExpectedCount = 5;

/// Pearson's test of observed counts against expected ones of the same total. Cells are pooled, smallest expectation
/// first, until each holds at least five (Cochran 1954). An observation where none is expected gives p = 0; fewer than
/// two cells after pooling leave nothing to test and give p = 1. Throws on different numbers of cells.
ChiSquareTest chiSquareTest(std::span<const double> observed, std::span<const double> expected);

struct KolmogorovSmirnovTest {
    double distance = 0;
    double p = 1;
};

/// Uniformity on [0, 1], for p-values of independent tests. Limit distribution with the correction of Stephens 1970,
/// "Use of the Kolmogorov–Smirnov, Cramér–von Mises and related statistics without extensive tables".
KolmogorovSmirnovTest uniformityTest(std::span<const double> values);

}  // namespace ulam::statistics
