#pragma once
// How well Markov chains mix, from traces of scalars (luminance, path length, raster position, feature label).
// All traces of one call have the same length, at least four; otherwise the functions throw.

#include <cstddef>
#include <span>
#include <vector>

namespace ulam::statistics {

using Trace = std::vector<double>;

/// Integrated autocorrelation time τ = 1 + 2 Σ ρ_t in draws, by Geyer's initial monotone sequence (Geyer 1992,
/// "Practical Markov chain Monte Carlo", section 3.3): sums of adjacent pairs of ρ, cut at the first that is ≤ 0 and
/// made non-increasing. The ρ are those of the mixture of all chains (Vehtari et al. 2021, eq. 10), so that chains
/// which disagree have a long time. The number N of all draws, divided by τ, is the effective sample size: the number
/// of independent ones whose mean has the same variance. At least 1 / log10(N), since negative correlations are
/// estimated poorly; N for chains that never move from one value. Costs O(N τ).
double autocorrelationTime(std::span<const Trace> chains);

/// Rank-normalised split R-hat, the larger of the bulk and the folded one (Vehtari et al. 2021, "Rank-normalization,
/// folding, and localization: an improved R-hat"). For few long chains; 1 is good, above 1.01 is not. Infinite for
/// chains that stand still in different places, 1 if all values are the same.
double splitRhat(std::span<const Trace> chains);

/// Nested R-hat (Margossian et al. 2022, "Nested R-hat: assessing the convergence of Markov chain Monte Carlo when
/// running many short chains"): √(1 + B / W) with B the variance of the means of super-chains and W the variance inside
/// them. For many short chains: each `chainsPerSuperchain` consecutive chains started from one point. Traces may have
/// length one if a super-chain has at least two chains.
double nestedRhat(std::span<const Trace> chains, std::size_t chainsPerSuperchain);

}  // namespace ulam::statistics
