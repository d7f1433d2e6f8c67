#pragma once
// Runs a plan: references first, then the cells in the plan's order. What is finished already is not done again.

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/engine/plan.h"
#include "experiments/engine/progress.h"

namespace ulam {

struct RunOptions {
    std::filesystem::path runDir;
    int threads = 1;
    bool keepGoing = false;  ///< a replicate or a reference that fails is reported, and the others go on
};

struct Failure {
    std::string scene;
    std::string cell;              ///< empty: the scene's reference failed
    std::optional<int> replicate;  ///< counts from 0 as the folders do; none: none was tried, for want of a reference
    std::string message;
};

struct RunOutcome {
    bool interrupted = false;
    int rendered = 0, reused = 0;  ///< replicates of cells
    std::vector<Failure> failures;
};

/// Writes experiment.json, resolved.json, provenance.json, references/ and cells/. Without keepGoing the first failing
/// reference or replicate throws; CannotWrite always does.
/// The replicates that "until" adds are added to the plan.
RunOutcome runPlan(Plan& plan, const RunOptions& options, const std::atomic<bool>& interrupt, Progress& progress);

/// RUN_DIR/cells/CELL
std::filesystem::path cellFolder(const std::filesystem::path& runDir, const Cell& cell);

}  // namespace ulam
