#include "experiments/engine/worker.h"

#include <algorithm>
#include <map>
#include <set>
#include <thread>
#include <type_traits>
#include <utility>

#include "core/base/error.h"
#include "core/base/file_lock.h"
#include "experiments/engine/lease.h"
#include "experiments/engine/provenance.h"
#include "experiments/engine/reference.h"
#include "experiments/engine/replicate.h"
#include "experiments/engine/result.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

/// Processes that may die over a replicate, one after the other, before it counts as failed.
constexpr int kMostDeaths = 5;
/// Seconds between looks at what others do: more and more, for many may wait for the last ones.
constexpr double kFirstPause = 0.1, kLongestPause = 10, kPausesPerLease = 8;

/// How much of the whole is done, in expected seconds: time budgets are known beforehand, other work is as long as that
/// of the same task was, and before that as long as an average piece.
class Workload {
public:
    void add(const Task& task, int replicates) { left_[&task] += replicates; }
    void skip(const Task& task) { --left_[&task]; }
    void drop(const Task& task) { left_[&task] = 0; }
    void finish(const Task& task, double seconds) {
        --left_[&task];
        spent_[&task].first += seconds;
        spent_[&task].second += 1;
        done_ += seconds;
    }

    double fraction() const { return ofAll(done_); }
    /// `current` is the fraction of the replicate that runs now, of `task`.
    double fraction(const Task& task, double current) const { return ofAll(done_ + current * expected(task)); }

private:
    double ofAll(double seconds) const {
        double all = done_;
        for (const auto& [t, count] : left_) all += count * expected(*t);
        return all > 0 ? std::min(1.0, seconds / all) : 0;
    }

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

/// Of this machine, held while a budget of time is rendered: two at once would be slower each. Nothing: another process
/// has it.
std::optional<FileLock> takeClock() {
    std::error_code ignored;  // without the folder there is no lock
    const fs::path temporary = fs::temp_directory_path(ignored);
    const fs::path folder = temporary.empty() ? temporary : temporary / "ulam-clock";
    fs::create_directory(folder, ignored);
    return FileLock::attempt(folder);
}

enum class Step { Done, Elsewhere, Stopped };

class Worker {
public:
    Worker(const Plan& plan, const RunOptions& options, const std::atomic<bool>& interrupt, Progress& progress)
        : plan_(plan), options_(options), interrupt_(interrupt), progress_(progress) {
        add(plan.order());
        std::set<std::size_t> needed;
        for (const Plan::Replicate& next : replicates_) needed.insert(plan.cells[next.cell].reference);
        for (std::size_t i = 0; i < plan.references.size(); ++i) {
            const Task& task = plan.references[i].task;
            UnfinishedReference reference{i, {}};
            for (int part = 0; part < task.replicates; ++part)
                if (isMine(task, part)) reference.parts.push_back(part);
            if (!reference.parts.empty() || needed.contains(i)) references_.push_back(std::move(reference));
        }
    }

    RunOutcome work(const MoreWork& more) {
        for (;;) {
            finish();
            if (outcome_.interrupted) break;
            add(more(withoutReference_));
            if (replicates_.empty()) break;
        }
        progress_.clear();
        return std::move(outcome_);
    }

private:
    void add(const std::vector<Plan::Replicate>& replicates) {
        for (const Plan::Replicate& next : replicates) {
            const Cell& cell = plan_.cells[next.cell];
            if (!isMine(cell.task, next.number) || withoutReference_.contains(cell.reference)) continue;
            replicates_.push_back(next);
            workload_.add(cell.task, 1);
        }
    }

    /// Until nothing is left, or a signal comes.
    void finish() {
        firstTime_ = true;
        for (double pause = kFirstPause;; pause *= 2) {
            const int before = settled_;
            std::erase_if(references_,
                          [&](UnfinishedReference& reference) { return !outcome_.interrupted && attempt(reference); });
            std::erase_if(replicates_, [&](const auto& next) { return !outcome_.interrupted && attempt(next); });
            firstTime_ = false;
            if (outcome_.interrupted || (references_.empty() && replicates_.empty())) break;
            if (settled_ > before) pause = kFirstPause;
            progress_.update(workload_.fraction(), fmt::format("other processes do the last {} pieces",
                                                               references_.size() + replicates_.size()));
            wait(std::min({pause, kLongestPause, options_.leaseSeconds / kPausesPerLease}));
            if (outcome_.interrupted) break;
        }
    }

    struct UnfinishedReference {
        std::size_t index;       ///< into the plan's
        std::vector<int> parts;  ///< not known to be done
        bool prepared = false;   ///< and to be made by a sampler
    };

    bool isMine(const Task& task, int replicate) const {
        return !options_.share || options_.share->contains({task.name, replicate});
    }

    bool mayGoOn(const Error& error) const { return options_.keepGoing && error.code() != ExitCode::CannotWrite; }

    /// Whether there is nothing more to do for the reference. Where it fails, the cells that need it are not tried.
    bool attempt(UnfinishedReference& waiting) {
        const PlannedReference& reference = plan_.references[waiting.index];
        const fs::path folder = referenceFolder(reference, options_.runDir);
        try {
            const bool settled = noteFailure(folder, [&] { return work(waiting, reference, folder); });
            settled_ += settled;
            return settled;
        } catch (const Error& error) {
            if (!mayGoOn(error)) throw;
            progress_.message(fmt::format("failed: reference of {}: {}", reference.scene->name, error.what()));
            outcome_.failures.push_back({reference.scene->name, "", {}, error.what()});
            workload_.drop(reference.task);
            for (const Cell& cell : plan_.cells) {
                if (cell.reference != waiting.index) continue;
                outcome_.failures.push_back({reference.scene->name, cell.task.name, {}, "its reference failed"});
                workload_.drop(cell.task);
            }
            std::erase_if(replicates_,
                          [&](const auto& next) { return plan_.cells[next.cell].reference == waiting.index; });
            withoutReference_.insert(waiting.index);
            return true;
        }
    }

    bool work(UnfinishedReference& waiting, const PlannedReference& reference, const fs::path& folder) {
        std::error_code ignored;
        if (isReady(reference, options_.runDir) && !fs::exists(partsFolder(reference, options_.runDir), ignored)) {
            tidy(folder);
            return true;
        }
        failIfFailed(folder);
        if (options_.share && waiting.parts.empty()) return true;
        if (!waiting.prepared) {
            makeFolder(folder);
            const auto lease = Lease::claim(folder, options_.leaseSeconds);
            if (!lease) return false;
            if (prepareReference(reference, options_.runDir)) return true;
            const int ready = readyParts(reference, options_.runDir);
            std::erase_if(waiting.parts, [&](int part) { return part < ready; });
            workload_.add(reference.task, int(waiting.parts.size()));
            waiting.prepared = true;
        }
        if (!makeParts(waiting, reference)) return false;
        if (options_.share && !allPartsAreThere(reference)) return true;
        const auto lease = Lease::claim(folder, options_.leaseSeconds);
        if (!lease) return options_.share.has_value();
        if (!isReady(reference, options_.runDir)) finishReference(reference, options_.runDir);
        return true;
    }

    bool makeParts(UnfinishedReference& waiting, const PlannedReference& reference) {
        const fs::path folder = partsFolder(reference, options_.runDir);
        std::erase_if(waiting.parts, [&](int part) {
            if (outcome_.interrupted) return false;
            // Another process may have combined the parts and removed them.
            if (isReady(reference, options_.runDir)) return true;
            const std::string what = fmt::format("reference of {}, part {} of {}", reference.scene->name, part + 1,
                                                 reference.task.replicates);
            const int before = reused_;
            if (doReplicate(reference.task, part, folder, what) != Step::Done) return false;
            outcome_.parts += reused_ == before;
            return true;
        });
        return waiting.parts.empty();
    }

    bool allPartsAreThere(const PlannedReference& reference) const {
        std::error_code ignored;
        for (int part = readyParts(reference, options_.runDir); part < reference.task.replicates; ++part)
            if (!fs::exists(replicateFolder(partsFolder(reference, options_.runDir), part) / "result.json", ignored))
                return false;
        return true;
    }

    /// Whether there is nothing more to do for the replicate.
    bool attempt(const Plan::Replicate& next) {
        const Cell& cell = plan_.cells[next.cell];
        const fs::path folder = cellFolder(options_.runDir, cell);
        const std::string what =
            fmt::format("{}, replicate {} of {}", cell.task.name, next.number + 1, cell.task.replicates);
        const int before = reused_;
        try {
            const Step step = noteFailure(replicateFolder(folder, next.number),
                                          [&] { return doReplicate(cell.task, next.number, folder, what); });
            if (step != Step::Done) return false;
            ++(reused_ > before ? outcome_.reused : outcome_.rendered);
        } catch (const Error& error) {
            if (!mayGoOn(error)) throw Error(error.code(), fmt::format("{}: {}", what, error.what()));
            outcome_.failures.push_back({cell.task.scene->name, cell.task.name, next.number, error.what()});
            progress_.message(fmt::format("failed: {}: {}", what, error.what()));
            workload_.skip(cell.task);
        }
        ++settled_;
        return true;
    }

    Step doReplicate(const Task& task, int replicate, const fs::path& folder, const std::string& what) {
        const fs::path place = replicateFolder(folder, replicate);
        if (isThere(task, replicate, folder)) return Step::Done;
        failIfFailed(place);
        if (interrupt_) return stopped();
        const bool timed = task.budget.seconds.has_value();
        const auto clock = timed ? takeClock() : std::nullopt;
        if (timed && !clock) return waitsForClock(what);
        makeFolder(place);
        const auto lease = Lease::claim(place, options_.leaseSeconds);
        if (!lease) return Step::Elsewhere;
        std::string damage;  // looked for now that nobody else writes there
        if (isThere(task, replicate, folder, &damage)) return Step::Done;
        if (lease->number() > kMostDeaths)
            fail(ExitCode::InvalidConfig, "{} processes have ended, one after the other, while they rendered it",
                 kMostDeaths);
        if (!damage.empty()) {
            progress_.message(fmt::format("{} is damaged and done again: {}", what, damage));
            removeAllButLeases(place);
        }
        const auto start = std::chrono::steady_clock::now();
        const auto report = [&](double fraction) {
            if (progress_.isDue()) progress_.update(workload_.fraction(task, fraction), what);
        };
        std::optional<PreviewPlan> preview;
        if (options_.show) preview = PreviewPlan{[&](Image image) { options_.show(what, std::move(image)); }};
        if (!renderReplicate(task, replicate, folder, options_.threads, interrupt_, report, preview)) return stopped();
        workload_.finish(task, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        forgetFailure(place);
        report(0);
        return Step::Done;
    }

    Step waitsForClock(const std::string& what) {
        if (!std::exchange(saidWaiting_, true))
            progress_.message(
                fmt::format("{} waits: another process on this machine renders for a budget of time", what));
        return Step::Elsewhere;
    }

    Step stopped() {
        outcome_.interrupted = true;
        return Step::Stopped;
    }

    bool isThere(const Task& task, int replicate, const fs::path& folder, std::string* damage = nullptr) {
        const auto finished = finishedReplicate(task, replicate, folder, damage);
        if (!finished) return false;
        if (!warnedOfBuilds_ && finished->result.value("code_sha256", "") != codeHash()) {
            progress_.message(fmt::format("warning: another build of the program or its plug-ins made {}, replicate {}: if they "
                                          "differ in more than looks, begin anew with another -o",
                                          task.name, replicate + 1));
            warnedOfBuilds_ = true;
        }
        const fs::path place = replicateFolder(folder, replicate);
        std::error_code ignored;  // of a process that was killed at the very end
        fs::remove(checkpointFile(folder, replicate), ignored);
        tidy(place);
        workload_.skip(task);
        ++reused_;
        return true;
    }

    /// What failed or ended before it was done, in the folder of what is done now.
    static void tidy(const fs::path& folder) {
        removeExpiredLeases(folder);
        forgetFailure(folder);
    }

    static void removeAllButLeases(const fs::path& folder) {
        std::error_code ignored;  // what cannot be removed cannot be written either, which says so
        std::vector<fs::path> all;
        for (fs::directory_iterator entry(folder, ignored); !ignored && entry != fs::directory_iterator();
             entry.increment(ignored))
            if (!isLeaseFile(entry->path().filename().string())) all.push_back(entry->path());
        for (const fs::path& path : all) fs::remove_all(path, ignored);
    }

    /// What failed before is tried again once where that is asked for: its record and the leases of the dead are
    /// removed.
    void failIfFailed(const fs::path& folder) const {
        if (options_.retryFailed && firstTime_) {
            tidy(folder);
        } else if (const auto failure = recordedFailure(folder)) {
            fail(ExitCode::InvalidConfig, "{} (on {}, {})", failure->message, failure->host, failure->time);
        }
    }

    /// What `work` throws is written down, for those who look and so that others do not try, unless it has been.
    template <class Work>
    static std::invoke_result_t<Work> noteFailure(const fs::path& folder, Work work) {
        const auto note = [&](const char* message) {
            if (!recordedFailure(folder)) recordFailure(folder, message);
        };
        try {
            return work();
        } catch (const Error& error) {
            if (error.code() != ExitCode::CannotWrite) note(error.what());
            throw;
        } catch (const std::exception& error) {
            note(error.what());
            throw;
        }
    }

    void wait(double seconds) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        while (!interrupt_ && std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        if (interrupt_) outcome_.interrupted = true;
    }

    const Plan& plan_;
    const RunOptions& options_;
    const std::atomic<bool>& interrupt_;
    Progress& progress_;
    Workload workload_;
    RunOutcome outcome_;
    std::set<std::size_t> withoutReference_;       // indices into the plan's references
    std::vector<UnfinishedReference> references_;  // that may need something done
    std::vector<Plan::Replicate> replicates_;      // the same, of cells
    bool firstTime_ = true;
    int reused_ = 0, settled_ = 0;
    bool warnedOfBuilds_ = false, saidWaiting_ = false;
};

}  // namespace

RunOutcome doWork(const Plan& plan, const RunOptions& options, const std::atomic<bool>& interrupt, Progress& progress,
                  const MoreWork& more) {
    return Worker(plan, options, interrupt, progress).work(more);
}

}  // namespace ulam
