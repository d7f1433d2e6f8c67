#pragma once
// The slope of error against cost on log–log axes: −1 for the MSE of an unbiased sampler that mixes.

#include <optional>
#include <span>

#include "experiments/statistics/curve.h"
#include "experiments/statistics/intervals.h"

namespace ulam::statistics {

struct Slope {
    double slope = 0;              // mean over replicates
    std::optional<Interval> ci95;  // Student's t over replicates; nothing below two
    bool flatter = false;          // the whole interval lies above −1: trapping or bias
};

/// A least-squares line per replicate: the snapshots of one run are correlated, the lines of different runs are not.
/// Nothing when an error is ≤ 0 or a curve has fewer than two different costs.
std::optional<Slope> fitSlope(std::span<const Curve> replicates);

}  // namespace ulam::statistics
