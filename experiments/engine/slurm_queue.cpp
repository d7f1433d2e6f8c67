#include "experiments/engine/slurm_queue.h"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <sstream>

#include "core/base/error.h"
#include "experiments/engine/run_folder.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

/// Lines of three fields, a task, its state and another one. Other lines are warnings.
template <class Take>
void readTasks(const std::vector<std::string>& command, Take take) {
    const CommandOutput listed = slurmCommand(command);
    if (listed.code != 0)
        fail(ExitCode::InputMissing, "{} does not tell what becomes of the jobs: {}", command.front(), listed.text);
    for (const std::string& line : linesOf(listed.text)) {
        const auto first = line.find('|'), second = line.find('|', first + 1);
        if (first != std::string::npos && second != std::string::npos)
            take(line.substr(0, first), line.substr(first + 1, second - first - 1), line.substr(second + 1));
    }
}

std::map<std::string, SlurmTask> askSacct(const std::vector<std::string>& jobs) {
    std::map<std::string, SlurmTask> tasks;
    readTasks({"sacct", "--noheader", "--parsable2", "--allocations", "--format=JobID,State,ExitCode",
               fmt::format("--jobs={}", fmt::join(jobs, ","))},
              [&](const std::string& task, const std::string& state, const std::string& exitCode) {
                  // "CANCELLED by 1000"
                  tasks[task] = {state.substr(0, state.find(' ')), exitCode == "0:0" ? "" : "exit code " + exitCode};
              });
    return tasks;
}

}  // namespace

std::string shellQuoted(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

CommandOutput slurmCommand(const std::vector<std::string>& command) {
    std::string line;
    for (const std::string& word : command) line += shellQuoted(word) + " ";
    std::FILE* const pipe = ::popen((line + "2>&1").c_str(), "r");
    if (!pipe) fail(ExitCode::InputMissing, "cannot start {}", command.front());
    CommandOutput output{0, ""};
    char block[4096];
    while (const std::size_t count = std::fread(block, 1, sizeof block, pipe)) output.text.append(block, count);
    const int status = ::pclose(pipe);
    output.code = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
    while (output.text.ends_with('\n')) output.text.pop_back();
    if (output.code == 127)
        fail(ExitCode::InputMissing, "{} is no command here: are Slurm's commands installed?", command.front());
    return output;
}

std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::vector<SubmittedArray> submittedArrays(const fs::path& runDir) {
    std::vector<SubmittedArray> arrays;
    std::error_code error;
    for (fs::directory_iterator entry(runDir / "jobs", error); !error && entry != fs::directory_iterator();
         entry.increment(error)) {
        const fs::path& folder = entry->path();
        if (!fs::exists(folder / "job.json", error)) continue;
        Json tasks = readOwnJson(folder / "tasks.json");
        arrays.push_back(
            {folder, readOwnJson(folder / "job.json").at("job"), tasks.at("kind"), std::move(tasks.at("tasks"))});
    }
    std::ranges::sort(arrays, {}, &SubmittedArray::folder);
    return arrays;
}

bool SlurmTask::hasEnded() const {
    constexpr std::array kEnds = {"BOOT_FAIL", "CANCELLED",     "COMPLETED", "DEADLINE", "FAILED",
                                  "NODE_FAIL", "OUT_OF_MEMORY", "PREEMPTED", "TIMEOUT"};
    return std::ranges::find(kEnds, state) != kEnds.end();
}

std::map<std::string, SlurmTask> askSqueue() {
    std::map<std::string, SlurmTask> tasks;
    readTasks({"squeue", "--noheader", "--array", "--states=all", "--format=%F_%K|%T|%r"},
              [&](const std::string& task, const std::string& state, const std::string& reason) {
                  tasks[task] = {state, reason == "None" ? "" : reason};
              });
    return tasks;
}

Json statusOfJobs(const fs::path& runDir) {
    const std::vector<SubmittedArray> submitted = submittedArrays(runDir);
    if (submitted.empty()) return {};
    Json arrays = Json::array(), trouble = Json::array();
    const auto answer = [&](const auto& ask) {
        try {
            return ask();
        } catch (const Error& error) {
            trouble.push_back(error.what());
            return std::map<std::string, SlurmTask>();
        }
    };
    std::map<std::string, SlurmTask> known = answer(askSqueue);
    const SlurmTask unknown = {trouble.empty() ? "ENDED" : "UNKNOWN", ""};
    std::vector<std::string> jobs;  // that squeue does not know all of
    for (const SubmittedArray& array : submitted)
        for (std::size_t i = 0; i < array.tasks.size(); ++i)
            if (!known.contains(array.task(i))) {
                jobs.push_back(array.job);
                break;
            }
    if (!jobs.empty()) known.merge(answer([&] { return askSacct(jobs); }));
    for (const SubmittedArray& array : submitted) {
        std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> groups;
        for (std::size_t i = 0; i < array.tasks.size(); ++i) {
            const auto found = known.find(array.task(i));
            const SlurmTask& task = found == known.end() ? unknown : found->second;
            groups[{task.state, task.reason}].push_back(i);
        }
        Json states = Json::array();
        for (const auto& [group, tasks] : groups)
            states.push_back({{"state", group.first}, {"reason", group.second}, {"tasks", tasks}});
        arrays.push_back({{"job", array.job},
                          {"kind", array.kind},
                          {"folder", array.folder.lexically_relative(runDir).string()},
                          {"tasks", array.tasks.size()},
                          {"states", states}});
    }
    return {{"arrays", arrays}, {"trouble", trouble}};
}

}  // namespace ulam
