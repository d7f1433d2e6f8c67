#pragma once
// Speed-up at equal error: the time the baseline needs to reach the mean error the sampler ended with, over the time
// the sampler took. The baseline's time is read off its mean curve (per snapshot the mean cost and the mean error over
// replicates) where it first reaches that error, by linear interpolation on log–log axes. Nothing is extrapolated: a
// baseline that never gets there, or was there before its first snapshot, gives no value, only a one-sided interval.

#include <optional>
#include <span>

#include "experiments/statistics/curve.h"
#include "experiments/statistics/design.h"
#include "experiments/statistics/intervals.h"

namespace ulam::statistics {

enum class SpeedupStatus {
    Reached,
    NeverReached,         // the speed-up is larger than the baseline's last cost over the sampler's
    BeforeFirstSnapshot,  // the speed-up is smaller than the baseline's first cost over the sampler's
    ErrorsNotPositive,    // some debiased error is ≤ 0: no value and no interval
};

struct Speedup {
    SpeedupStatus status = SpeedupStatus::Reached;
    std::optional<double> value;
    /// Of resamples over replicates (both sides). high is infinite where more resamples than the upper tail never reach
    /// the error, low is 0 where more than the lower tail reach it before the first snapshot. Nothing below two
    /// replicates on either side.
    std::optional<Interval> ci95;
};

/// `samplerEnds` holds the last snapshot of each replicate of the sampler. Throws when the replicates of the baseline
/// differ in their number of snapshots, or where pairs are not as many on both sides. The interval is the bootstrap
/// percentile one with the tails of bootstrapTail for the smaller group; pairs are drawn together.
Speedup speedup(std::span<const CurvePoint> samplerEnds, std::span<const Curve> baseline,
                const Design& design = {});

}  // namespace ulam::statistics
