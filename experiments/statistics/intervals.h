#pragma once
// Intervals over replicates (independent complete runs), of 95 % unless asked for another confidence. Simulated coverage:
// docs/statistics.md.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "experiments/statistics/philox_stream.h"
#include "experiments/statistics/welch.h"

namespace ulam::statistics {

struct Interval {
    double low = 0;
    double high = 0;
};

inline constexpr double kConfidence = 0.95;
inline constexpr std::size_t kBootstrapReplicates = 32;  // the bootstrap takes over from here on
inline constexpr std::size_t kBootstrapResamples = 10'000;

enum class IntervalMethod {
    LogT,     // Student's t on the log scale
    LinearT,  // Student's t on the linear scale: some values are not positive, so that there is no log scale
    Bca,      // bias-corrected and accelerated bootstrap
};

std::string_view intervalMethodName(IntervalMethod method);

struct MeanInterval {
    Interval interval;
    IntervalMethod method = IntervalMethod::LogT;
};

/// Probability to leave out at each end of a bootstrap distribution of so many replicates. Less than 2.5 %: resampling
/// underestimates the variance by (n - 1) / n and knows nothing of Student's t (Hesterberg 2015, "What teachers should
/// know about the bootstrap", section 5.4). Without it BCa covers 92 % of lognormal errors at 32 replicates.
double bootstrapTail(std::size_t replicates, double confidence = kConfidence);

/// Student's t for a mean on the linear scale, for quantities that are no errors (shares, slopes).
/// Nothing below two values.
std::optional<Interval> studentInterval(std::span<const double> values, double confidence = kConfidence);

/// Of the expected error E[x], not of its geometric mean: below 32 replicates log(mean) ± t s / (mean √n), from there
/// BCa (Efron 1987, "Better bootstrap confidence intervals") with the tails of bootstrapTail. Debiased errors can be ≤
/// 0; then the interval is Student's t on the linear scale, and `method` says so. Nothing below two values.
std::optional<MeanInterval> meanInterval(std::span<const double> errors, double confidence = kConfidence,
                                         std::uint64_t seed = kResamplingSeed);

/// log(E[a] / E[b]) of two independent groups of positive values: delta method, Welch–Satterthwaite degrees of freedom.
MeanEstimate logOfRatio(std::span<const double> a, std::span<const double> b);
/// Of pairs, whose covariance counts. Fails with InvalidConfig where there are not as many of the one as of the other.
MeanEstimate logOfPairedRatio(std::span<const double> a, std::span<const double> b);

/// Of E[a] / E[b], two independent groups: Student's t on the log scale, BCa when both groups have at least 32 replicates.
/// Nothing when a value is ≤ 0 or a group has fewer than two.
std::optional<Interval> ratioInterval(std::span<const double> a, std::span<const double> b,
                                      double confidence = kConfidence);

/// The same of pairs: a[i] and b[i] are of runs with common random numbers. The bootstrap draws pairs.
std::optional<Interval> pairedRatioInterval(std::span<const double> a, std::span<const double> b,
                                            double confidence = kConfidence);

}  // namespace ulam::statistics
