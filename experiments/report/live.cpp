#include "experiments/report/live.h"

#include "core/base/error.h"
#include "experiments/engine/run_folder.h"
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
    const Json content = {seen.planned.time_since_epoch().count(), seen.totals, seen.referencesReady, seen.finished};
    const bool something = seen.finished || seen.totals.value("done", 0) > 0;
    if (something && content != made_ && Clock::now() >= nextReport_) {
        const auto start = Clock::now();
        try {
            made = std::make_shared<const std::string>(reportPage(runDir_, summary(seen)));
            made_ = content;
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
    seen.planned = timeOf(runDir_ / "resolved.json");
    seen.summarized = timeOf(runDir_ / "summary.json");
    if (seen.planned == FileTime::min()) {
        seen.message = fmt::format("waiting for a run in {}", runDir_.string());
        return seen;
    }
    const Json status = statusOfRun(runDir_);
    seen.name = status["name"].get<std::string>();
    seen.totals = status["totals"];
    for (const Json& reference : status["references"]) {
        ++seen.references;
        seen.referencesReady += reference["state"] == "ready";
    }
    seen.finished = isSummaryOf(seen);
    const bool running = seen.totals["running"].get<int>() > 0;
    seen.message = seen.finished                            ? "finished"
                   : seen.referencesReady < seen.references ? "making references"
                   : running                                ? "running"
                                                            : "nobody works at it now";
    return seen;
}

/// Whether summary.json is newer than the plan and of as many replicates as are done.
bool LiveReport::isSummaryOf(const Seen& seen) {
    if (seen.summarized < seen.planned) return false;
    if (summarized_.first != seen.summarized) {
        int replicates = 0;
        const Json summary = readOwnJson(runDir_ / "summary.json");
        for (const Json& cell : summary.value("cells", Json::array())) replicates += cell.value("replicates", 0);
        summarized_ = {seen.summarized, replicates};
    }
    return summarized_.second == seen.totals["done"].get<int>();
}

Json LiveReport::summary(const Seen& seen) {
    if (seen.finished) return readOwnJson(runDir_ / "summary.json");
    if (planned_ != seen.planned) {
        plan_.reset();  // two at a time may not have room
        plan_ = planOfRun(runDir_);
        planned_ = seen.planned;
    }
    std::vector<Failure> failures;
    for (const Cell& cell : plan_->cells) {
        const PlannedReference& reference = plan_->references[cell.reference];
        if (timeOf(runDir_ / "references" / reference.key / "result.json") == FileTime::min())
            failures.push_back({cell.task.scene->name, cell.task.name, {}, "it has no reference yet"});
    }
    return summarize(*plan_, runDir_, failures);
}

void LiveReport::publish(const Seen& seen, std::shared_ptr<const std::string> page) {
    const std::lock_guard lock(mutex_);
    const int version = state_["version"].get<int>() + (page ? 1 : 0);
    state_ = {{"version", version},
              {"name", seen.name},
              {"message", seen.message},
              {"totals", seen.totals},
              {"references", {{"ready", seen.referencesReady}, {"all", seen.references}}}};
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
