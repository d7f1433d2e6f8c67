#pragma once
// Does what a run still lacks, beside other processes and hosts that do the same in its folder.

#include <functional>
#include <set>

#include "experiments/engine/run.h"

namespace ulam {

/// Asked when all is done: replicates that are wanted beyond those of the plan when the work began. `withoutReference`
/// has the indices of the references that failed.
using MoreWork = std::function<std::vector<Plan::Replicate>(const std::set<std::size_t>& withoutReference)>;

/// Parts of references first, then replicates of cells in the plan's order; what other processes have a lease of is
/// looked at again until it is there, has failed, or their lease has expired. With a share only that is done; whoever
/// makes the last part of a reference combines them. Failures leave their reason in the folder (recordFailure), and are
/// not tried by others.
RunOutcome doWork(const Plan& plan, const RunOptions& options, const std::atomic<bool>& interrupt, Progress& progress,
                  const MoreWork& more);

}  // namespace ulam
