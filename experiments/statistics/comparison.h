#pragma once
// One sampler against its baseline on the primary metric, and the verdict over all comparisons of a run.

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/statistics/design.h"

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
    double p = 1;                  // of equal mean errors: permutation test, of pairs the sign-flip test
    double pAdjusted = 1;          // set by decide
    Verdict verdict = Verdict::Undecided;  // set by decide
    bool referenceTooPoor = false;         // some debiased error is ≤ 0, or see kReferenceShare: never decided
    bool heavyTailed = false;              // see kHeavyTail: the interval may cover less than 95 %
    /// The ratio below 1, nearest to it, that these replicates would have decided in 80 % of runs: what an undecided
    /// comparison tells. Nothing where ci95 is nothing or no ratio can be decided; set by decide.
    std::optional<double> detectableRatio;
    double varianceOfLog = 0;  // of the ratio, with so many degrees of freedom
    double degrees = 0;
    double smallestP = 1;  // that so many replicates can reach
};

/// Errors of the replicates. `referenceVariance` is what debiasing subtracted from each error, 0 for an exact reference.
Comparison compare(std::span<const double> sampler, std::span<const double> baseline, double referenceVariance = 0,
                   const Design& design = {});

/// Holm over all comparisons of a run, each look at its share of the level. The verdict is better or worse only where the adjusted p is at most 0.05 and the
/// interval of the ratio excludes 1: where the spreads of the groups differ much the permutation test alone names too
/// many winners.
void decide(std::span<Comparison> comparisons, int looks = 1);

/// The smallest adjusted p each comparison can reach with these (sampler, baseline) numbers of replicates.
std::vector<double> smallestAdjustedP(std::span<const std::pair<std::size_t, std::size_t>> replicates,
                                      const Design& design = {});

}  // namespace ulam::statistics
