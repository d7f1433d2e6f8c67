#include "experiments/engine/run.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/base/file.h"
#include "experiments/engine/provenance.h"
#include "experiments/engine/reference.h"
#include "experiments/engine/replicate.h"
#include "experiments/engine/sequential.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

/// How much of the whole is done, in expected seconds: time budgets are known beforehand, other work is as long as that
/// of the same task was, and before that as long as an average piece.
class Workload {
public:
    explicit Workload(const Plan& plan) {
        for (const Cell& cell : plan.cells) left_[&cell.task] = cell.task.replicates;
    }

    void add(const Task& task, int replicates) { left_[&task] += replicates; }
    void skip(const Task& task) { --left_[&task]; }
    void drop(const Task& task) { left_[&task] = 0; }
    void finish(const Task& task, double seconds) {
        --left_[&task];
        spent_[&task].first += seconds;
        spent_[&task].second += 1;
        done_ += seconds;
    }

    /// `current` is the fraction of the replicate that runs now, of `task`.
    double fraction(const Task& task, double current) const {
        double remaining = 0;
        for (const auto& [t, count] : left_) remaining += count * expected(*t);
        const double now = done_ + current * expected(task), all = done_ + remaining;
        return all > 0 ? std::min(1.0, now / all) : 0;
    }

private:
    double expected(const Task& task) const {
        if (const auto own = spent_.find(&task); own != spent_.end()) return own->second.first / own->second.second;
        if (task.budget.seconds) return *task.budget.seconds;
        double seconds = 0, count = 0;
        for (const auto& [t, spent] : spent_) seconds += spent.first, count += spent.second;
        return count > 0 ? seconds / count : 1;
    }

    std::map<const Task*, int> left_;
    std::map<const Task*, std::pair<double, double>> spent_;  // seconds and replicates
    double done_ = 0;
};

class Runner {
public:
    Runner(Plan& plan, const RunOptions& options, const std::atomic<bool>& interrupt, Progress& progress)
        : plan_(plan), options_(options), interrupt_(interrupt), progress_(progress), workload_(plan) {}

    RunOutcome run() {
        writeHeader();
        makeReferences();
        std::vector<int> done(plan_.cells.size(), 0);
        do renderCells(done);
        while (wantsMore(done));
        progress_.clear();
        return std::move(outcome_);
    }

private:
    void writeHeader() {
        makeFolder(options_.runDir);
        Json origin = provenance(processArguments());
        origin["threads"] = options_.threads;
        writeFileAtomically(options_.runDir / "experiment.json", dump(plan_.experiment) + "\n");
        writeFileAtomically(options_.runDir / "provenance.json", dump(origin) + "\n");
        writeResolved();
    }

    void writeResolved() { writeFileAtomically(options_.runDir / "resolved.json", dump(plan_.resolved()) + "\n"); }

    /// After a look at what there is. `done` becomes the number of replicates that were tried of each cell.
    bool wantsMore(std::vector<int>& done) {
        if (outcome_.interrupted || !plan_.until) return false;
        for (std::size_t c = 0; c < done.size(); ++c) done[c] = plan_.cells[c].task.replicates;
        const int added = addReplicates(plan_, options_.runDir, withoutReference_);
        if (added == 0) return false;
        for (std::size_t c = 0; c < done.size(); ++c)
            workload_.add(plan_.cells[c].task, plan_.cells[c].task.replicates - done[c]);
        writeResolved();
        progress_.message(fmt::format("not decided yet: {} replicates more", added));
        return true;
    }

    void makeReferences() {
        std::vector<std::size_t> missing;
        for (std::size_t i = 0; i < plan_.references.size(); ++i)
            attempt(i, [&] {
                if (!prepareReference(plan_.references[i], options_.runDir)) missing.push_back(i);
            });
        for (const std::size_t i : missing) {
            const PlannedReference& reference = plan_.references[i];
            workload_.add(reference.task, reference.task.replicates - readyParts(reference, options_.runDir));
        }
        for (const std::size_t i : missing) {
            attempt(i, [&] { makeParts(plan_.references[i]); });
            if (outcome_.interrupted) return;
        }
    }

    void makeParts(const PlannedReference& reference) {
        const fs::path folder = partsFolder(reference, options_.runDir);
        for (int part = readyParts(reference, options_.runDir); part < reference.task.replicates; ++part) {
            const std::string what = fmt::format("reference of {}, part {} of {}", reference.scene->name, part + 1,
                                                 reference.task.replicates);
            if (!doReplicate(reference.task, part, folder, what)) return;
        }
        finishReference(reference, options_.runDir);
    }

    bool mayGoOn(const Error& error) const { return options_.keepGoing && error.code() != ExitCode::CannotWrite; }

    /// A step towards a reference. Where it fails, the cells that need the reference are not tried.
    template <class Step>
    void attempt(std::size_t index, Step step) {
        const PlannedReference& reference = plan_.references[index];
        try {
            step();
        } catch (const Error& error) {
            if (!mayGoOn(error)) throw;
            progress_.message(fmt::format("failed: reference of {}: {}", reference.scene->name, error.what()));
            outcome_.failures.push_back({reference.scene->name, "", {}, error.what()});
            workload_.drop(reference.task);
            for (const Cell& cell : plan_.cells) {
                if (cell.reference != index) continue;
                outcome_.failures.push_back({reference.scene->name, cell.task.name, {}, "its reference failed"});
                workload_.drop(cell.task);
            }
            withoutReference_.insert(index);
        }
    }

    void renderCells(const std::vector<int>& done) {
        if (outcome_.interrupted) return;
        for (const Plan::Replicate& next : plan_.order(done)) {
            const Cell& cell = plan_.cells[next.cell];
            if (withoutReference_.contains(cell.reference)) continue;
            const std::string what =
                fmt::format("{}, replicate {} of {}", cell.task.name, next.number + 1, cell.task.replicates);
            const int before = reused_;
            try {
                if (!doReplicate(cell.task, next.number, cellFolder(options_.runDir, cell), what)) return;
                ++(reused_ > before ? outcome_.reused : outcome_.rendered);
            } catch (const Error& error) {
                if (!mayGoOn(error)) throw Error(error.code(), fmt::format("{}: {}", what, error.what()));
                outcome_.failures.push_back({cell.task.scene->name, cell.task.name, next.number, error.what()});
                progress_.message(fmt::format("failed: {}: {}", what, error.what()));
                workload_.skip(cell.task);
            }
        }
    }

    /// Returns false where a signal came.
    bool doReplicate(const Task& task, int replicate, const fs::path& folder, const std::string& what) {
        std::string damage;
        if (finishedReplicate(task, replicate, folder, &damage)) {
            std::error_code ignored;  // of a run that was killed at the very end
            fs::remove(checkpointFile(folder, replicate), ignored);
            workload_.skip(task);
            ++reused_;
            return true;
        }
        if (!damage.empty()) {
            progress_.message(fmt::format("{} is damaged and done again: {}", what, damage));
            std::error_code ignored;  // what cannot be removed cannot be written either, which says so
            fs::remove_all(replicateFolder(folder, replicate), ignored);
        }
        const auto start = std::chrono::steady_clock::now();
        const auto report = [&](double fraction) { progress_.update(workload_.fraction(task, fraction), what); };
        if (interrupt_ || !renderReplicate(task, replicate, folder, options_.threads, interrupt_, report)) {
            outcome_.interrupted = true;
            return false;
        }
        workload_.finish(task, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        report(0);
        return true;
    }

    Plan& plan_;
    const RunOptions& options_;
    const std::atomic<bool>& interrupt_;
    Progress& progress_;
    Workload workload_;
    RunOutcome outcome_;
    std::set<std::size_t> withoutReference_;  // indices into the plan's references
    int reused_ = 0;
};

}  // namespace

RunOutcome runPlan(Plan& plan, const RunOptions& options, const std::atomic<bool>& interrupt,
                   Progress& progress) {
    return Runner(plan, options, interrupt, progress).run();
}

fs::path cellFolder(const fs::path& runDir, const Cell& cell) {
    return runDir / "cells" / cell.task.name;
}

}  // namespace ulam
