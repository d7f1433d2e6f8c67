// ulam work: renders what a run lacks, beside other processes and hosts. ulam status: what is there, and who works at
// what.

#include "core/base/error.h"
#include "core/base/file.h"
#include "experiments/cli/arguments.h"
#include "experiments/cli/commands.h"
#include "experiments/engine/reference.h"
#include "experiments/engine/run_folder.h"
#include "experiments/engine/signals.h"
#include "experiments/engine/slurm.h"
#include "experiments/engine/slurm_queue.h"
#include "experiments/engine/worker.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

struct WorkArguments {
    std::string folder, task;
    std::shared_ptr<int> threads;
    std::shared_ptr<double> lease;
    bool quiet = false;
};

void work(const WorkArguments& a) {
    Plan plan = planOfRun(a.folder);
    RunOptions options;
    options.runDir = a.folder;
    options.threads = *a.threads;
    options.keepGoing = true;
    options.retryFailed = false;
    options.leaseSeconds = *a.lease;
    if (!a.task.empty()) options.share = shareOfTask(a.task);
    removeTemporaries(referenceCache(), Below::No);
    Progress progress(a.quiet);
    const RunOutcome outcome =
        doWork(plan, options, watchSignals(), progress, [&](const auto&) { return addedReplicates(plan, a.folder); });
    if (outcome.interrupted) failIfSignalled("finished replicates are kept, and others may go on with the rest");
    fmt::print("{} replicates and {} parts of references are new, {} replicates were there already\n", outcome.rendered,
               outcome.parts, outcome.reused);
    if (!outcome.failures.empty())
        fail(ExitCode::SomeCellsFailed,
             "{} pieces of work failed: see ulam status {}; ulam run --resume tries them again",
             outcome.failures.size(), inQuotes(a.folder));
}

std::string holderText(const Json& held) {
    const std::string host = held["host"], job = held["job"];
    if (host.empty()) return "somebody";
    return fmt::format("process {} on {}{}, since {}", held["process"].get<int>(), host,
                       job.empty() ? "" : ", job " + job, held["since"].get<std::string>());
}

/// A line for each replicate that somebody works or worked at, or that failed.
void printPieces(const std::string& name, const char* unit, const Json& status) {
    const auto line = [&](const char* state, const Json& piece, const std::string& text) {
        fmt::print("{}: {}, {} {} of {}: {}\n", state, name, unit, piece["replicate"].get<int>() + 1,
                   status["replicates"].get<int>(), text);
    };
    for (const Json& piece : status["running"]) line("running", piece, holderText(piece));
    for (const Json& piece : status["expired"]) line("expired", piece, holderText(piece));
    for (const Json& piece : status["failed"])
        line("failed", piece,
             fmt::format("{} (on {}, {})", piece["message"].get<std::string>(), piece["host"].get<std::string>(),
                         piece["time"].get<std::string>()));
}

void printStatus(const Json& status) {
    const auto counts = [](const Json& of) {
        std::vector<std::string> parts;
        for (const char* state : {"done", "running", "expired", "failed", "missing"}) {
            const std::size_t count = of[state].is_array() ? of[state].size() : of[state].get<std::size_t>();
            if (count > 0) parts.push_back(fmt::format("{} {}", count, state));
        }
        return fmt::format("{}", fmt::join(parts, ", "));
    };
    for (const Json& reference : status["references"]) {
        const std::string name = reference["reference"];
        const bool parts = reference.contains("parts");
        fmt::print("reference {}: {}{}\n", name, reference["state"].get<std::string>(),
                   parts ? ", parts: " + counts(reference["parts"]) : "");
        if (reference.contains("message"))
            fmt::print("failed: reference {}: {} (on {}, {})\n", name, reference["message"].get<std::string>(),
                       reference["host"].get<std::string>(), reference["time"].get<std::string>());
        if (parts) printPieces(name, "part", reference["parts"]);
    }
    for (const Json& cell : status["cells"]) {
        fmt::print("cell {}: {}\n", cell["cell"].get<std::string>(), counts(cell));
        printPieces(cell["cell"], "replicate", cell);
    }
    fmt::print("{} replicates: {}\n", status["totals"]["replicates"].get<std::size_t>(), counts(status["totals"]));
}

/// "12_[0-4,7]", which scancel and scontrol understand.
std::string tasksText(const std::string& job, const Json& tasks) {
    std::vector<std::string> ranges;
    for (std::size_t first = 0, next = 0; first < tasks.size(); first = next) {
        for (next = first + 1; next < tasks.size() && tasks[next] == tasks[next - 1].get<std::size_t>() + 1;) ++next;
        ranges.push_back(next == first + 1 ? tasks[first].dump() : tasks[first].dump() + "-" + tasks[next - 1].dump());
    }
    return fmt::format("{}_[{}]", job, fmt::join(ranges, ","));
}

void printQueue(const Json& jobs) {
    for (const Json& array : jobs["arrays"]) {
        const std::string job = array["job"];
        fmt::print("job {}: {}, {} tasks, logs in {}\n", job, array["kind"].get<std::string>(),
                   array["tasks"].get<std::size_t>(), array["folder"].get<std::string>());
        for (const Json& group : array["states"]) {
            const std::string reason = group["reason"];
            fmt::print("{}{}: {}\n", group["state"].get<std::string>(), reason.empty() ? "" : " (" + reason + ")",
                       tasksText(job, group["tasks"]));
        }
    }
    for (const Json& trouble : jobs["trouble"]) fmt::print("{}\n", trouble.get<std::string>());
}

}  // namespace

void addWorkCommand(CLI::App& app) {
    auto a = std::make_shared<WorkArguments>();
    CLI::App& command =
        *app.add_subcommand("work", "render what a run still lacks, beside other processes and hosts that do the same");
    command.add_option("run", a->folder, "folder of the run, as ulam run made it")->type_name("RUN_DIR")->required();
    a->threads = addThreadsOption(command);
    a->lease = addLeaseOption(command);
    command.add_option("--task", a->task, "only what task N of a job array is for, as ulam run --jobs wrote it")
        ->type_name("FILE:N");
    addMemoryOption(command);
    command.add_flag("--quiet", a->quiet, "no progress");
    addPluginOption(command);
    addResourceOption(command);
    command.callback([a] { work(*a); });
}

void addStatusCommand(CLI::App& app) {
    auto folder = std::make_shared<std::string>();
    auto json = std::make_shared<bool>(false);
    CLI::App& command = *app.add_subcommand("status",
                                            "what of a run is done, who works at what, what failed and why, what is "
                                            "missing, and what Slurm says of its jobs");
    command.add_option("run", *folder, "folder of the run")->type_name("RUN_DIR")->required();
    command.add_flag("--json", *json, "print all of it as JSON");
    command.callback([folder, json] {
        Json status = statusOfRun(*folder);
        if (!*json) {
            printStatus(status);
            std::fflush(stdout);  // Slurm may take its time to answer
        }
        const Json jobs = statusOfJobs(*folder);
        if (*json) {
            if (!jobs.is_null()) status["slurm"] = jobs;
            fmt::print("{}\n", dump(status));
        } else if (!jobs.is_null()) {
            printQueue(jobs);
        }
    });
}

}  // namespace ulam
