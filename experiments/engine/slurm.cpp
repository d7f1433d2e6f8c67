#include "experiments/engine/slurm.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <map>
#include <optional>
#include <sstream>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/suggest.h"
#include "experiments/engine/estimate.h"
#include "experiments/engine/provenance.h"
#include "experiments/engine/reference.h"
#include "experiments/engine/replicate.h"
#include "experiments/engine/result.h"
#include "experiments/engine/sequential.h"
#include "experiments/engine/slurm_queue.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

using Piece = std::pair<std::string, int>;  // name of a task of the plan, number of a replicate

/// Tasks of an array, at most: Slurm's own limit, and files that each task reads quickly.
constexpr std::size_t kMostTasks = 1000;

/// A folder that no other array has, also where several are submitted at once.
fs::path newArrayFolder(const fs::path& runDir) {
    makeFolder(runDir / "jobs");
    std::error_code error;
    for (int n = 1;; ++n) {
        const fs::path folder = runDir / "jobs" / fmt::format("{:03}", n);
        if (fs::create_directory(folder, error)) return folder;
        if (error) fail(ExitCode::CannotWrite, "cannot make the folder {}: {}", folder.string(), error.message());
    }
}

std::set<Piece> piecesOf(const Json& task) {
    std::set<Piece> pieces;
    for (const Json& piece : task) pieces.emplace(piece.at(0).get<std::string>(), piece.at(1).get<int>());
    return pieces;
}

struct Queue {
    std::set<Piece> pieces;               ///< of tasks that wait or run
    std::set<std::string> referenceJobs;  ///< that have such tasks
};

/// What Slurm still has of the run's earlier arrays.
Queue readQueue(const fs::path& runDir) {
    Queue queue;
    const std::vector<SubmittedArray> arrays = submittedArrays(runDir);
    if (arrays.empty()) return queue;
    const std::map<std::string, SlurmTask> known = askSqueue();
    for (const SubmittedArray& array : arrays)
        for (std::size_t i = 0; i < array.tasks.size(); ++i) {
            const auto task = known.find(array.task(i));
            if (task == known.end() || task->second.hasEnded()) continue;
            queue.pieces.merge(piecesOf(array.tasks[i]));
            if (array.kind == "references") queue.referenceJobs.insert(array.job);
        }
    return queue;
}

/// Slurm's MaxArraySize, which counts the numbers from 0.
std::size_t largestArray() {
    for (const std::string& line : linesOf(slurmCommand({"scontrol", "show", "config"}).text)) {
        std::size_t size = 0;
        if (line.starts_with("MaxArraySize") && std::sscanf(line.c_str(), "MaxArraySize = %zu", &size) == 1)
            return std::clamp<std::size_t>(size, 1, kMostTasks);
    }
    return kMostTasks;
}

class Submission {
public:
    Submission(Plan& plan, const RunOptions& options, const SlurmOptions& slurm,
               const std::vector<std::string>& workOptions)
        : plan_(plan), options_(options), slurm_(slurm), workOptions_(workOptions), queue_(readQueue(options.runDir)) {}

    std::vector<JobArray> submit(Progress& progress) {
        const Work references = missingParts();
        Work cells, timed;
        for (auto wanted = plan_.order(); !wanted.empty();) {
            for (const Plan::Replicate& next : wanted) {
                const Cell& cell = plan_.cells[next.cell];
                const State state = stateOf(cell.task, next.number, cellFolder(options_.runDir, cell));
                if (state == State::Missing || state == State::Failed)
                    (cell.task.budget.seconds ? timed : cells).push_back({&cell.task, next.number});
                mayLook_ &= state == State::Finished || (options_.keepGoing && state == State::Failed) ||
                            withoutReference_.contains(cell.reference);
            }
            wanted.clear();
            if (mayLook_) wanted = nextLook(plan_, options_.runDir, withoutReference_, progress);
        }
        if (plan_.until)
            progress.message(
                mayLook_ ? "\"until\" asks for no more replicates"
                         : "\"until\" looks at the errors when these replicates are there: then give this command "
                           "again, with --resume");
        // Only now: tasks that start in the meantime find the replicates that earlier looks have added.
        writeHeader(plan_, options_);
        if (references.empty() && cells.empty() && timed.empty()) return {};
        largestArray_ = largestArray();
        estimate();
        submit(references, "references", {});
        std::vector<std::string> afterReferences;
        for (const JobArray& array : arrays_) queue_.referenceJobs.insert(array.job);
        // Whatever became of them: a task whose reference has failed says so and does nothing.
        if (!queue_.referenceJobs.empty())
            afterReferences.push_back(fmt::format("--dependency=afterany:{}", fmt::join(queue_.referenceJobs, ":")));
        submit(cells, "cells", afterReferences);
        afterReferences.push_back("--exclusive");
        submit(timed, "timed cells", afterReferences);
        return std::move(arrays_);
    }

private:
    using Work = std::vector<std::pair<const Task*, int>>;

    /// Of references that are neither there nor in the cache.
    Work missingParts() {
        Work missing;
        for (std::size_t i = 0; i < plan_.references.size(); ++i) {
            const PlannedReference& reference = plan_.references[i];
            const fs::path folder = referenceFolder(reference, options_.runDir);
            makeFolder(folder);
            const bool failed = recordedFailure(folder).has_value();
            forgetFailure(folder);
            const auto lease = Lease::claim(folder, options_.leaseSeconds);
            if (lease && prepareReference(reference, options_.runDir)) continue;
            if (options_.keepGoing && failed)
                withoutReference_.insert(i);
            else
                mayLook_ = false;
            bool finished = true;
            for (int part = readyParts(reference, options_.runDir); part < reference.task.replicates; ++part) {
                const State state = stateOf(reference.task, part, partsFolder(reference, options_.runDir));
                finished &= state == State::Finished && !isQueued(reference.task, part);
                if (state == State::Missing || state == State::Failed) missing.push_back({&reference.task, part});
            }
            // Whoever made the last part did not come to combine them: who has that part to do will.
            if (lease && finished) missing.push_back({&reference.task, reference.task.replicates - 1});
        }
        return missing;
    }

    bool isQueued(const Task& task, int replicate) const { return queue_.pieces.contains({task.name, replicate}); }

    enum class State { Finished, Awaited, Failed, Missing };

    /// Awaited: in the queue, or held by a process. The traces of what is to be tried again are removed.
    State stateOf(const Task& task, int replicate, const fs::path& folder) const {
        // Finished is finished, even where Slurm runs its task once more.
        if (finishedReplicate(task, replicate, folder)) return State::Finished;
        if (isQueued(task, replicate)) return State::Awaited;
        const fs::path place = replicateFolder(folder, replicate);
        const auto holder = leaseHolder(place);
        if (holder && !holder->expired) return State::Awaited;
        const State state = recordedFailure(place) ? State::Failed : State::Missing;
        removeExpiredLeases(place);
        forgetFailure(place);
        return state;
    }

    /// On as many processors as a task gets.
    void estimate() {
        const PlanEstimate estimate = estimatePlan(plan_, options_.threads);
        const auto note = [&](const Task& task, double seconds) {
            seconds_[&task] = task.budget.seconds ? seconds : seconds * options_.threads / slurm_.cpusPerTask;
        };
        for (std::size_t i = 0; i < plan_.cells.size(); ++i) note(plan_.cells[i].task, estimate.cells[i].seconds);
        for (std::size_t i = 0; i < plan_.references.size(); ++i)
            note(plan_.references[i].task, estimate.references[i].seconds);
    }

    /// In tasks of about the same length, and arrays of as many as Slurm takes.
    void submit(const Work& work, const std::string& kind, const std::vector<std::string>& sbatch) {
        std::vector<double> seconds;
        for (const auto& [task, replicate] : work) seconds.push_back(seconds_.at(task));
        std::vector<Work> tasks;
        for (const std::vector<std::size_t>& share : shareOut(seconds, 60 * slurm_.taskMinutes))
            tasks.push_back(pick(work, share));
        for (std::size_t first = 0; first < tasks.size(); first += largestArray_)
            submitArray({tasks.begin() + std::ptrdiff_t(first),
                         tasks.begin() + std::ptrdiff_t(std::min(tasks.size(), first + largestArray_))},
                        kind, sbatch);
    }

    void submitArray(const std::vector<Work>& tasks, const std::string& kind, const std::vector<std::string>& sbatch) {
        const fs::path folder = fs::absolute(newArrayFolder(options_.runDir)).lexically_normal();
        JobArray array{"", kind, tasks.size(), 0, 0};
        Json list = Json::array();
        for (const Work& task : tasks) {
            Json pieces = Json::array();
            for (const auto& [of, replicate] : task) {
                pieces.push_back({of->name, replicate});
                array.seconds += seconds_.at(of);
            }
            array.replicates += task.size();
            list.push_back(std::move(pieces));
        }
        // Not indented: each of the array's tasks reads all of it.
        writeFileAtomically(folder / "tasks.json",
                            Json{{"schema_version", 1}, {"kind", kind}, {"tasks", list}}.dump() + "\n");
        writeFileAtomically(folder / "job.sh", script(folder));
        std::vector<std::string> command = {"sbatch",
                                            "--parsable",
                                            fmt::format("--array=0-{}", tasks.size() - 1),
                                            "--open-mode=append",
                                            "--job-name=" + plan_.name,
                                            "--output=" + (folder / "%a.log").string()};
        command.insert(command.end(), sbatch.begin(), sbatch.end());
        command.insert(command.end(), slurm_.sbatch.begin(), slurm_.sbatch.end());
        command.push_back((folder / "job.sh").string());
        const CommandOutput output = slurmCommand(command);
        if (output.code != 0) fail(ExitCode::Usage, "sbatch refuses the job: {}", output.text);
        const std::string answer = linesOf(output.text).back();  // "12" or "12;cluster", after warnings
        array.job = answer.substr(0, answer.find(';'));
        writeFileAtomically(
            folder / "job.json",
            dump({{"schema_version", 1}, {"job", array.job}, {"command", command}, {"submitted", utcNow()}}) + "\n");
        arrays_.push_back(std::move(array));
    }

    std::string script(const fs::path& folder) const {
        std::string options;
        for (const std::string& option : workOptions_) options += " " + shellQuoted(option);
        return fmt::format(R"(#!/bin/sh
# A renderer that was killed is started again: it goes on from its checkpoint. The time limit and a cancelled job end it with
# SIGTERM, which the shell outlives until the checkpoint is written.
trap : TERM INT
for attempt in 1 2 3; do
    {} work {} --task {}:"$SLURM_ARRAY_TASK_ID" --threads "${{SLURM_CPUS_ON_NODE:-1}}" --quiet{}
    code=$?
    [ $code -gt 128 ] && [ $code -ne 130 ] && [ $code -ne 143 ] || break
done
exit $code
)",
                           shellQuoted(fs::read_symlink("/proc/self/exe").string()),
                           shellQuoted(fs::absolute(options_.runDir).lexically_normal().string()),
                           shellQuoted((folder / "tasks.json").string()), options);
    }

    Plan& plan_;
    const RunOptions& options_;
    const SlurmOptions& slurm_;
    const std::vector<std::string>& workOptions_;
    Queue queue_;
    bool mayLook_ = true;                     // all is there that a look at the errors waits for
    std::set<std::size_t> withoutReference_;  // indices into the plan's references, of those that are not waited for
    std::size_t largestArray_ = kMostTasks;
    std::map<const Task*, double> seconds_;  // expected, of a replicate
    std::vector<JobArray> arrays_;
};

}  // namespace

SlurmOptions parseSlurmOptions(const std::string& text) {
    const std::string system = text.substr(0, text.find(':'));
    if (system != "slurm") fail(ExitCode::Usage, "--jobs: expected slurm or slurm:OPTIONS, found {}", inQuotes(text));
    SlurmOptions options;
    std::istringstream stream(text.size() > system.size() ? text.substr(system.size() + 1) : "");
    const auto number = [&](const std::string& key, const std::string& value, auto& result) {
        const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), result);
        if (error != std::errc() || stop != value.data() + value.size() || !(result > 0))
            fail(ExitCode::Usage, "--jobs: expected a number above 0 for {}, found {}", key, inQuotes(value));
    };
    for (std::string option; std::getline(stream, option, ',');) {
        const auto equals = option.find('=');
        const std::string key = option.substr(0, equals),
                          value = equals == std::string::npos ? "" : option.substr(equals + 1);
        if (key.empty() || key.starts_with("-"))
            fail(ExitCode::Usage, "--jobs: expected KEY=VALUE, as partition=short, found {}", inQuotes(option));
        for (const char* ours : {"array", "dependency", "job-name", "open-mode", "output", "parsable", "wait", "wrap"})
            if (key == ours) fail(ExitCode::Usage, "--jobs: {} is set by ulam and cannot be given", key);
        if (key == "task-minutes") {
            number(key, value, options.taskMinutes);
            continue;
        }
        if (key == "cpus-per-task") number(key, value, options.cpusPerTask);
        options.sbatch.push_back("--" + option);
    }
    return options;
}

std::vector<std::vector<std::size_t>> shareOut(const std::vector<double>& seconds, double usual) {
    struct Portion {
        std::vector<std::size_t> pieces;
        double seconds = 0;
    };
    std::vector<Portion> portions;
    std::optional<std::size_t> open;  // which takes the next piece that is not long
    for (std::size_t i = 0; i < seconds.size(); ++i) {
        if (seconds[i] >= usual) {
            portions.push_back({{i}, seconds[i]});
            continue;
        }
        // A piece belongs to the portion in whose time its middle lies.
        if (!open || portions[*open].seconds + seconds[i] / 2 > usual) {
            open = portions.size();
            portions.emplace_back();
        }
        portions[*open].pieces.push_back(i);
        portions[*open].seconds += seconds[i];
    }
    if (open && portions[*open].seconds < usual * kShortestShare) {
        const Portion rest = portions[*open];
        portions.erase(portions.begin() + std::ptrdiff_t(*open));
        const auto shortest = std::ranges::min_element(portions, {}, &Portion::seconds);
        if (shortest != portions.end() && shortest->seconds + rest.seconds <= usual * kLongestShare)
            shortest->pieces.insert(shortest->pieces.end(), rest.pieces.begin(), rest.pieces.end());
        else
            portions.push_back(rest);
    }
    std::vector<std::vector<std::size_t>> pieces;
    for (Portion& portion : portions) pieces.push_back(std::move(portion.pieces));
    return pieces;
}

std::vector<JobArray> submitMissing(Plan& plan, const RunOptions& options, const SlurmOptions& slurm,
                                    const std::vector<std::string>& workOptions, Progress& progress) {
    return Submission(plan, options, slurm, workOptions).submit(progress);
}

std::set<Piece> shareOfTask(const std::string& text) {
    const auto colon = text.rfind(':');
    std::size_t index = 0;
    const char* const end = text.data() + text.size();
    if (colon == std::string::npos || std::from_chars(text.data() + colon + 1, end, index).ptr != end ||
        colon + 1 == text.size())
        fail(ExitCode::Usage, "--task: expected FILE:N, found {}", inQuotes(text));
    const JsonDocument document = JsonDocument::fromFile(text.substr(0, colon));
    const JsonNode tasks = document.root().at("tasks");
    if (index >= tasks.size())
        fail(ExitCode::Usage, "--task: {} has tasks 0 to {}, not {}", document.name(), tasks.size() - 1, index);
    return piecesOf(tasks[index].json());
}

}  // namespace ulam
