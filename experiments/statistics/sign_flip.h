#pragma once
// The paired randomisation test of equal mean errors, two-sided (Fisher 1935, "The Design of Experiments", section 21).
//
// Pairs are replicates of two samplers that used common random numbers. Where the samplers do not differ, the members of
// a pair can be exchanged, which turns the sign of their difference: the statistic |Σ ± d| of all signs is then as likely
// as that of the signs found. It orders the signs as Student's |t| of the differences does, Σ d² being the same for all.

#include <cstddef>
#include <cstdint>
#include <span>

#include "experiments/statistics/philox_stream.h"

namespace ulam::statistics {

/// Fails with InvalidConfig where there are not as many of the one as of the other.
void requirePairs(std::span<const double> a, std::span<const double> b);

/// All signs up to kExactSplits of them (17 pairs), else kRandomSplits random ones. Needs at least one pair.
double signFlipP(std::span<const double> a, std::span<const double> b, std::uint64_t seed = kResamplingSeed);

/// The smallest p that so many pairs can reach: 2 of all signs, or 1 / (m + 1) where signs are drawn.
double smallestSignFlipP(std::size_t pairs);

}  // namespace ulam::statistics
