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

    /// For the page around the report: its "version" (0: there is none), "name" and "message", numbers of replicates
    /// "done", "begun", "failed" and "all", and of references "references_done" and "references".
    Json state() const;
    /// As report.html; null where nothing is finished. Both may be called by any thread.
    std::shared_ptr<const std::string> page() const;

private:
    using Clock = std::chrono::steady_clock;
    using FileTime = std::filesystem::file_time_type;

    /// What the folder holds now.
    struct Seen {
        /// When files were written; the earliest time: there is none.
        FileTime planned = FileTime::min(), lastResult = FileTime::min(), summarized = FileTime::min();
        int done = 0, begun = 0, failed = 0, all = 0, referencesDone = 0, references = 0;
        std::string message;

        bool isFinished() const { return summarized > FileTime::min() && summarized >= lastResult; }
        bool operator==(const Seen&) const = default;
    };

    Seen look();
    void countReplicates(const Cell& cell, Seen& seen) const;
    bool hasReference(const PlannedReference& reference) const;
    Json summary(const Seen& seen) const;
    void publish(const Seen& seen, std::shared_ptr<const std::string> page);

    const std::filesystem::path runDir_;
    std::optional<Plan> plan_;
    FileTime planned_ = FileTime::min();  ///< when the files of plan_ were written
    FileTime summarized_ = FileTime::min();
    int failures_ = 0;          ///< in the summary written then
    std::optional<Seen> made_;  ///< what the report was made of
    std::string trouble_;       ///< why the newest report could not be made
    Clock::time_point nextLook_, nextReport_;

    mutable std::mutex mutex_;  // of what follows
    Json state_ = {{"version", 0}};
    std::shared_ptr<const std::string> page_;
};

}  // namespace ulam
