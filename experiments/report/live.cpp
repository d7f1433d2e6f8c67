#include "experiments/report/live.h"

#include "core/base/error.h"
#include "experiments/engine/provenance.h"
#include "experiments/engine/replicate.h"
#include "experiments/engine/summary.h"
#include "experiments/report/report.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

using Seconds = std::chrono::duration<double>;

constexpr Seconds kLookInterval{0.5}, kReportInterval{2};
// Of the time, at most. A run on the same machine has the rest.
constexpr double kLookShare = 0.02, kReportShare = 0.1;

/// The earliest time where there is no such file.
fs::file_time_type timeOf(const fs::path& file) {
    std::error_code missing;
    const fs::file_time_type time = fs::last_write_time(file, missing);
    return missing ? fs::file_time_type::min() : time;
}

/// When to do again what was begun at a time.
std::chrono::steady_clock::time_point nextTime(std::chrono::steady_clock::time_point begun, Seconds interval,
                                               double share) {
    const auto now = std::chrono::steady_clock::now();
    const Seconds pause = std::max(interval, Seconds(now - begun) / share);
    return now + std::chrono::duration_cast<std::chrono::steady_clock::duration>(pause);
}

}  // namespace

void LiveReport::update() {
    const auto begin = Clock::now();
    if (begin < nextLook_) return;
    Seen seen;
    try {
        seen = look();
    } catch (const std::exception& error) {
        seen.message = error.what();
    }
    nextLook_ = nextTime(begin, kLookInterval, kLookShare);

    std::shared_ptr<const std::string> made;
    const bool something = seen.done > 0 || seen.isFinished();
    if (something && seen != made_ && Clock::now() >= nextReport_) {
        const auto start = Clock::now();
        try {
            made = std::make_shared<const std::string>(reportPage(runDir_, summary(seen)));
            made_ = seen;
            trouble_.clear();
        } catch (const std::exception& error) {
            trouble_ = error.what();
        }
        nextReport_ = nextTime(start, kReportInterval, kReportShare);
    }
    if (!trouble_.empty()) seen.message = trouble_;
    publish(seen, std::move(made));
}

LiveReport::Seen LiveReport::look() {
    Seen seen;
    // The first and the last of the files that a plan is made from.
    seen.planned = std::min(timeOf(runDir_ / "experiment.json"), timeOf(runDir_ / "provenance.json"));
    if (seen.planned == FileTime::min()) {
        seen.message = fmt::format("waiting for a run in {}", runDir_.string());
        return seen;
    }
    if (seen.planned != planned_) {
        plan_.reset();  // two at a time may not have room
        plan_ = planOfRun(runDir_);
        planned_ = seen.planned;
    }
    seen.references = int(plan_->references.size());
    for (const PlannedReference& reference : plan_->references) seen.referencesDone += hasReference(reference);
    for (const Cell& cell : plan_->cells) countReplicates(cell, seen);
    seen.summarized = timeOf(runDir_ / "summary.json");
    if (seen.isFinished()) {
        if (summarized_ != seen.summarized) failures_ = int(summary(seen).value("failures", Json::array()).size());
        summarized_ = seen.summarized;
        seen.failed = failures_;
        seen.begun = 0;
    }
    seen.message = seen.isFinished()                       ? "finished"
                   : seen.referencesDone < seen.references ? "making references"
                                                           : "running";
    return seen;
}

void LiveReport::countReplicates(const Cell& cell, Seen& seen) const {
    seen.all += cell.task.replicates;
    for (int r = 0; r < cell.task.replicates; ++r) {
        const fs::path folder = replicateFolder(cellFolder(runDir_, cell), r);
        const FileTime time = timeOf(folder / "result.json");
        seen.lastResult = std::max(seen.lastResult, time);
        if (time > FileTime::min())
            ++seen.done;
        else if (timeOf(folder) > FileTime::min())
            ++seen.begun;
    }
}

bool LiveReport::hasReference(const PlannedReference& reference) const {
    return timeOf(runDir_ / "references" / reference.key / "result.json") > FileTime::min();
}

Json LiveReport::summary(const Seen& seen) const {
    if (seen.isFinished()) return JsonDocument::fromFile(runDir_ / "summary.json").json();
    std::vector<Failure> failures;
    for (const Cell& cell : plan_->cells)
        if (!hasReference(plan_->references[cell.reference]))
            failures.push_back({cell.task.scene->name, cell.task.name, {}, "it has no reference yet"});
    Json made = summarize(*plan_, runDir_, failures);
    if (made["cells"].empty())
        fail(ExitCode::InvalidConfig, "no replicate that is finished was made by this version of the program, {}",
             programVersion());
    return made;
}

void LiveReport::publish(const Seen& seen, std::shared_ptr<const std::string> page) {
    const std::lock_guard lock(mutex_);
    const int version = state_["version"].get<int>() + (page ? 1 : 0);
    state_ = {{"version", version},
              {"name", plan_ ? plan_->name : ""},
              {"message", seen.message},
              {"done", seen.done},
              {"begun", seen.begun},
              {"failed", seen.failed},
              {"all", seen.all},
              {"references_done", seen.referencesDone},
              {"references", seen.references}};
    if (page) page_ = std::move(page);
}

Json LiveReport::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

std::shared_ptr<const std::string> LiveReport::page() const {
    const std::lock_guard lock(mutex_);
    return page_;
}

}  // namespace ulam
