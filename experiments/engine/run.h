#pragma once
// Runs a plan: references first, then the cells in the plan's order. What is finished already is not done again, and other
// processes may join in (worker.h).

#include <atomic>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "experiments/engine/lease.h"
#include "experiments/engine/plan.h"
#include "experiments/engine/progress.h"

namespace ulam {

struct RunOptions {
    std::filesystem::path runDir;
    int threads = 1;
    bool keepGoing = false;   ///< a replicate or a reference that fails is reported, and the others go on
    bool retryFailed = true;  ///< what has failed before, here or in another process, is tried again
    double leaseSeconds = kLeaseSeconds;
    /// Names of tasks and numbers of replicates that are to be done; none: all.
    std::optional<std::set<std::pair<std::string, int>>> share = {};
    std::function<void(const std::string& name, Image image)> show = {};  ///< see PreviewPlan; none: no previews
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
    int parts = 0;                 ///< of references, rendered
    std::vector<Failure> failures;
};

/// Writes experiment.json, resolved.json and provenance.json. From then on other processes can work in the folder.
void writeHeader(const Plan& plan, const RunOptions& options);

/// resolved.json alone: the replicates that "until" asks for may become more.
void writeResolved(const Plan& plan, const std::filesystem::path& runDir);

/// Writes the header, and references/ and cells/ as doWork does. Without keepGoing the first failing reference or replicate
/// throws; CannotWrite always does. The replicates that "until" adds are added to the plan.
RunOutcome runPlan(Plan& plan, const RunOptions& options, const std::atomic<bool>& interrupt, Progress& progress);

/// RUN_DIR/cells/CELL
std::filesystem::path cellFolder(const std::filesystem::path& runDir, const Cell& cell);

}  // namespace ulam
