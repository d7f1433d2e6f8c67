#pragma once
// How the replicates of a comparison came about, which decides the tests and intervals that hold for them.

#include "experiments/statistics/intervals.h"

namespace ulam::statistics {

struct Design {
    /// Replicate i of the sampler and of the baseline had common random numbers.
    bool paired = false;
    /// How often the errors may be looked at, once each time replicates were added, to decide whether to add more. Every
    /// look has the level 0.05 / looks (Bonferroni), so that stopping at any of them, for whatever reason, names a wrong
    /// winner with at most 5 %, and all intervals together cover with at least 95 %.
    int looks = 1;

    double confidence() const { return 1 - (1 - kConfidence) / looks; }
};

}  // namespace ulam::statistics
