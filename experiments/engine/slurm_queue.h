#pragma once
// The job arrays of a run that were submitted, and what Slurm's commands say of their tasks.

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/config/json.h"

namespace ulam {

struct SubmittedArray {
    std::filesystem::path folder;  ///< RUN_DIR/jobs/001
    std::string job;               ///< its number
    std::string kind;              ///< as JobArray::kind
    Json tasks;                    ///< of each what it does

    /// Slurm's name of a task: "12_3".
    std::string task(std::size_t index) const { return fmt::format("{}_{}", job, index); }
};
/// In the order in which they were submitted.
std::vector<SubmittedArray> submittedArrays(const std::filesystem::path& runDir);

/// As one word for sh.
std::string shellQuoted(const std::string& text);

struct CommandOutput {
    int code;
    std::string text;  ///< of both streams, without line ends at its end
};
/// Fails with InputMissing where there is no such command.
CommandOutput slurmCommand(const std::vector<std::string>& command);
std::vector<std::string> linesOf(const std::string& text);

struct SlurmTask {
    std::string state;   ///< in Slurm's words: "PENDING"
    std::string reason;  ///< why it waits or how it failed: "Dependency", "NonZeroExitCode"; empty: none

    bool hasEnded() const;
};
/// All that squeue knows, by name: who waits or runs, and, for some minutes, who has ended. Fails with InputMissing
/// where it does not answer.
std::map<std::string, SlurmTask> askSqueue();

/// What became of the tasks of a run: of each array the tasks in each state, from squeue and, for those that it does
/// not know any more, from sacct. Where both say nothing, the state is "ENDED", or "UNKNOWN" if squeue did not answer.
/// "trouble" says which of the two did not, and why. Null where nothing was submitted.
Json statusOfJobs(const std::filesystem::path& runDir);

}  // namespace ulam
