#pragma once
// One sampler against its baseline on the primary metric, and the verdict over all comparisons of a run.

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/statistics/intervals.h"

namespace ulam::statistics {

/// Level of the whole family of comparisons.
inline constexpr double kFamilyLevel = 0.05;
/// A reference whose variance exceeds this share of the smallest error is too poor to judge it.
inline constexpr double kReferenceShare = 0.1;
/// Coverage is checked up to this standard deviation of the log errors; heavier tails are flagged.
inline constexpr double kHeavyTail = 0.5;

enum class Verdict { Undecided, Better, Worse };

std::string_view verdictName(Verdict verdict);

struct Comparison {
    std::optional<double> ratio;   // E[error of sampler] / E[error of baseline]; nothing unless both means are positive
    std::optional<Interval> ci95;  // of the ratio; nothing if an error is ≤ 0 or a group has fewer than two replicates
    double p = 1;                  // permutation test of equal mean errors
    double pAdjusted = 1;          // set by decide
    Verdict verdict = Verdict::Undecided;  // set by decide
    bool referenceTooPoor = false;         // some debiased error is ≤ 0, or see kReferenceShare: never decided
    bool heavyTailed = false;              // see kHeavyTail: the interval may cover less than 95 %
};

/// Errors of independent replicates. `referenceVariance` is what debiasing subtracted from each error, 0 for an exact
/// reference.
Comparison compare(std::span<const double> sampler, std::span<const double> baseline, double referenceVariance = 0);

/// Holm over all comparisons of a run. The verdict is better or worse only where the adjusted p is at most 0.05 and the
/// interval of the ratio excludes 1: where the spreads of the groups differ much the permutation test alone names too
/// many winners.
void decide(std::span<Comparison> comparisons);

/// The smallest adjusted p each comparison can reach with these (sampler, baseline) numbers of replicates.
std::vector<double> smallestAdjustedP(std::span<const std::pair<std::size_t, std::size_t>> replicates);

}  // namespace ulam::statistics
