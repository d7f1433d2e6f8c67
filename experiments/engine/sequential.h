#pragma once
// Adding replicates until an experiment has its answer ("until"). Each look at the errors has its share of the level
// (statistics/design.h), so that it does not matter when and why it stops.

#include <set>

#include "experiments/engine/cell_errors.h"
#include "experiments/engine/progress.h"

namespace ulam {

/// Brings the cells that need more to twice the replicates that any cell has, up to the most: those of comparisons that
/// are neither decided nor known to the wanted width, and of cells without a comparison whose mean error is not. A cell
/// that opens late catches up, so that no comparison is looked at more often than the plan has looks. What a poor reference
/// keeps undecided gets none, nor do cells `without` a reference (indices into Plan::references). Returns how many there
/// are more.
int addReplicates(Plan& plan, const std::filesystem::path& runDir, const std::set<std::size_t>& without = {});

/// The next look of an experiment with "until", when all replicates so far are there: those that it adds to the plan,
/// which it says. None of one without.
std::vector<Plan::Replicate> nextLook(Plan& plan, const std::filesystem::path& runDir,
                                      const std::set<std::size_t>& without, Progress& progress);

}  // namespace ulam
