#pragma once
// The two-sample permutation test of equal mean errors, two-sided.
//
// Statistic: Welch's |t| of the difference of the means. The claim a comparison makes is about the ratio of mean
// errors, so the statistic must be one of the means: one of mean logs could name a winner whose ratio points the other
// way. Studentising keeps the test exact when both groups have one distribution and makes it asymptotically right when
// only their means agree (Janssen 1997; Chung & Romano 2013, "Exact and asymptotically robust permutation tests"). With
// groups of equal size it orders the splits exactly as the difference of the means does.

#include <cstddef>
#include <cstdint>
#include <span>

#include "experiments/statistics/philox_stream.h"

namespace ulam::statistics {

/// Up to this many splits are enumerated (10 against 10 replicates are 184 756).
inline constexpr std::size_t kExactSplits = 200'000;
/// Random splits drawn beyond; p is then (b + 1) / (m + 1), which keeps the level (Phipson & Smyth 2010).
inline constexpr std::size_t kRandomSplits = 99'999;

/// Both groups need at least one value. A group of one leaves no variance: the difference itself is then the statistic.
double permutationP(std::span<const double> a, std::span<const double> b, std::uint64_t seed = kResamplingSeed);

/// The smallest p that groups of these sizes can reach: 2 of all splits for equal sizes (a split and its mirror image),
/// else 1; 1 / (m + 1) where splits are drawn.
double smallestPermutationP(std::size_t sizeA, std::size_t sizeB);

}  // namespace ulam::statistics
