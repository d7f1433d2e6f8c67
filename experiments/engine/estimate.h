#pragma once
// What a plan will cost, from short trials.

#include <vector>

#include "experiments/engine/plan.h"

namespace ulam {

/// Of one replicate: wall seconds of its render, and bytes of its folder.
struct Cost {
    double seconds = 0, bytes = 0;
};

/// By a trial of about a third of a second. A time budget is taken at its word. Of samplers with chains the seeding is
/// extrapolated by its own plan (docs/seeding.md). How well this does: docs/experiments.md.
Cost estimateReplicate(const Task& task, int threads);

/// Of a whole plan. Beyond so many cells only some are tried, of each sampler on each scene the same share at random (at
/// least one); the others are taken to need what these do for a unit of work, or second of budget, and for a pixel.
inline constexpr std::size_t kTriedCells = 100;

struct PlanEstimate {
    std::vector<Cost> cells;       ///< of one replicate of each
    std::vector<Cost> references;    ///< of a part of each; none where nothing is missing or no sampler makes it
    std::vector<int> missingParts;   ///< of each, those that the cache does not hold
    std::size_t tried = 0;             ///< cells that were

    /// Of everything together. Space is that of the run's folder when it is done, without tables and report.
    Cost total(const Plan& plan) const;
};
PlanEstimate estimatePlan(const Plan& plan, int threads);

}  // namespace ulam
