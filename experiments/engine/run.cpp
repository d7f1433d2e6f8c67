#include "experiments/engine/run.h"

#include "core/base/file.h"
#include "experiments/engine/provenance.h"
#include "experiments/engine/result.h"
#include "experiments/engine/sequential.h"
#include "experiments/engine/worker.h"

namespace ulam {

namespace fs = std::filesystem;

void writeHeader(const Plan& plan, const RunOptions& options) {
    makeFolder(options.runDir);
    Json origin = provenance(processArguments());
    origin["threads"] = options.threads;
    writeFileAtomically(options.runDir / "experiment.json", dump(plan.experiment) + "\n");
    writeFileAtomically(options.runDir / "provenance.json", dump(origin) + "\n");
    writeResolved(plan, options.runDir);
}

void writeResolved(const Plan& plan, const fs::path& runDir) {
    writeFileAtomically(runDir / "resolved.json", dump(plan.resolved()) + "\n");
}

RunOutcome runPlan(Plan& plan, const RunOptions& options, const std::atomic<bool>& interrupt, Progress& progress) {
    writeHeader(plan, options);
    const auto whatUntilAdds = [&](const std::set<std::size_t>& withoutReference) {
        std::vector<Plan::Replicate> added = nextLook(plan, options.runDir, withoutReference, progress);
        if (!added.empty()) writeResolved(plan, options.runDir);
        return added;
    };
    return doWork(plan, options, interrupt, progress, whatUntilAdds);
}

fs::path cellFolder(const fs::path& runDir, const Cell& cell) {
    return runDir / "cells" / cell.task.name;
}

}  // namespace ulam
