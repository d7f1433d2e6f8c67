#pragma once
// What can be said of a run while it goes on: how much is done, and the report of that.

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "experiments/engine/plan.h"

namespace ulam {

/// Follows the folder of a run, which need not be there yet, and only reads it.
class LiveReport {
public:
    explicit LiveReport(std::filesystem::path runDir) : runDir_(std::move(runDir)) {}

    /// Looks at the folder, and makes the report again where something has changed. Takes a small share of the time:
    /// called often, it mostly returns at once. Called by one thread.
    void update();

    /// For the page around the report: its "version" (0: there is none), the run's "name", a "message", "totals" of
    /// replicates as in statusOfRun, and of "references" how many are "ready" and there are in "all".
    Json state() const;
    /// As report.html; null where nothing is finished. Both may be called by any thread.
    std::shared_ptr<const std::string> page() const;

private:
    using Clock = std::chrono::steady_clock;
    using FileTime = std::filesystem::file_time_type;

    /// What the folder holds now.
    struct Seen {
        /// When resolved.json and summary.json were written; the earliest time: they are not there.
        FileTime planned = FileTime::min(), summarized = FileTime::min();
        std::string name, message;
        Json totals = Json::object();
        int references = 0, referencesReady = 0;
        bool finished = false;  ///< summary.json is of all that is done
    };

    Seen look();
    bool isSummaryOf(const Seen& seen);
    Json summary(const Seen& seen);
    void publish(const Seen& seen, std::shared_ptr<const std::string> page);

    const std::filesystem::path runDir_;
    std::optional<Plan> plan_;
    FileTime planned_ = FileTime::min();  ///< of the resolved.json that plan_ is of
    std::pair<FileTime, int> summarized_ = {FileTime::min(),
                                            0};  ///< when summary.json was written, of how many replicates
    Json made_;                                  ///< what the report was made of
    std::string trouble_;                        ///< why the newest report could not be made
    Clock::time_point nextLook_, nextReport_;

    mutable std::mutex mutex_;  // of what follows
    Json state_ = {{"version", 0}};
    std::shared_ptr<const std::string> page_;
};

}  // namespace ulam
