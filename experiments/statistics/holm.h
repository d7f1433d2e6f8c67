#pragma once
// Corrections for testing many hypotheses at once. Adjusted p-values keep the order of the input and are compared with
// the level of the whole family.

#include <span>
#include <vector>

namespace ulam::statistics {

/// Step-down Bonferroni (Holm 1979, "A simple sequentially rejective multiple test procedure"): right for any
/// dependence. It increases in every p, so holmAdjusted(smallest attainable p of each) is the smallest attainable
/// adjusted p of each.
std::vector<double> holmAdjusted(std::span<const double> p);

/// 1 - (1 - p)^n, for independent tests such as tiles (Šidák 1967); precise for tiny p.
std::vector<double> sidakAdjusted(std::span<const double> p);

/// Step-up false discovery rate (Benjamini & Hochberg 1995, "Controlling the false discovery rate"): of the hypotheses with
/// an adjusted p of at most q, a share of at most q is true on average. For independent or positively dependent tests,
/// such as pixels.
std::vector<double> benjaminiHochbergAdjusted(std::span<const double> p);

}  // namespace ulam::statistics
