// ulam run: plan, run, analyse, report.

#include <cstdlib>
#include <numeric>
#include <set>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/file_lock.h"
#include "core/base/memory.h"
#include "core/config/suggest.h"
#include "experiments/cli/arguments.h"
#include "experiments/cli/commands.h"
#include "experiments/engine/estimate.h"
#include "experiments/engine/extends.h"
#include "experiments/engine/reference.h"
#include "experiments/engine/result.h"
#include "experiments/engine/signals.h"
#include "experiments/engine/slurm.h"
#include "experiments/engine/summary.h"
#include "experiments/engine/tev.h"
#include "experiments/engine/tuning.h"
#include "experiments/report/report.h"
#include "experiments/statistics/comparison.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

struct RunArguments {
    std::string experiment, folder, jobs;
    std::vector<std::string> workOptions;  ///< for those who work in jobs
    std::vector<std::string> assignments;
    std::shared_ptr<int> threads;
    std::shared_ptr<double> lease;
    std::shared_ptr<std::string> viewer;
    bool resume = false, dryRun = false, keepGoing = false, quiet = false, json = false;
};

/// $ULAM_RUNS/NAME-N or runs/NAME-N: the first N that is free, which is made, or the last one that is there.
fs::path defaultFolder(const std::string& name, bool last) {
    const char* given = std::getenv("ULAM_RUNS");
    const fs::path parent = given && *given ? given : "runs";
    const auto folder = [&](int n) { return parent / fmt::format("{}-{}", name, n); };
    int n = 1;
    while (fs::exists(folder(n))) ++n;
    if (last && n > 1) return folder(n - 1);
    makeFolder(parent);
    std::error_code error;
    while (!fs::create_directory(folder(n), error) && !error) ++n;  // another process may be faster
    if (error) fail(ExitCode::CannotWrite, "cannot make the folder {}: {}", folder(n).string(), error.message());
    return folder(n);
}

/// Where a bias would not be seen, or the verdict cannot come out significant, whatever the errors.
std::vector<std::string> planWarnings(const Plan& plan) {
    std::vector<std::string> warnings = sharedBiasWarnings(plan);
    const std::vector<double> p = plan.smallestAdjustedP();
    if (!p.empty() && *std::ranges::max_element(p) > statistics::kFamilyLevel)
        warnings.push_back(fmt::format(
            "too few replicates for a verdict, whatever the errors: of {} comparisons the smallest adjusted p that "
            "can come out is {:.2g}, above {}; raise \"replicates\"",
            p.size(), *std::ranges::max_element(p), statistics::kFamilyLevel));
    return warnings;
}

/// What is planned and what it will cost: resolved.json with estimates.
Json plannedJson(const Plan& plan, const PlanEstimate& estimate) {
    Json planned = plan.resolved();
    const auto note = [](Json& place, const Cost& of, int replicates) {
        place["estimated_seconds"] = of.seconds * replicates;
        place["estimated_bytes"] = of.bytes * replicates;
    };
    for (std::size_t i = 0; i < plan.cells.size(); ++i)
        note(planned["cells"][i], estimate.cells[i], plan.cells[i].task.replicates);
    for (std::size_t i = 0; i < plan.references.size(); ++i)
        if (plan.references[i].spec.kind == ReferenceSpec::Kind::Sampler) {
            Json& reference = planned["references"][plan.references[i].key];
            reference["missing_parts"] = estimate.missingParts[i];
            note(reference, estimate.references[i], estimate.missingParts[i]);
        }
    note(planned, estimate.total(plan), 1);
    planned["tried_cells"] = estimate.tried;
    planned["warnings"] = planWarnings(plan);
    return planned;
}

/// Of all rounds: each candidate is taken to cost what the sampler does as it is written.
double tuningSeconds(const Plan& plan, const PlanEstimate& estimate, const Tuning& tuning) {
    double whole = 0;
    std::set<std::string> scenes;  // of a sweep one point
    for (std::size_t c = 0; c < plan.cells.size(); ++c) {
        const Task& task = plan.cells[c].task;
        if (task.sampler == tuning.sampler && scenes.insert(task.scene->name).second) whole += estimate.cells[c].seconds;
    }
    double seconds = 0;
    for (const TuningRound& round : tuningRounds(tuning))
        seconds += round.fraction * double(round.candidates) * tuning.parameters.replicates * whole;
    return seconds;
}

void printDryRun(const Plan& plan, const std::optional<Tuning>& tuning, const RunArguments& a) {
    const PlanEstimate estimate = estimatePlan(plan, *a.threads);
    Json planned = plannedJson(plan, estimate);
    if (tuning)
        planned["tuning"] = {{"sampler", tuning->sampler},
                             {"candidates", tuning->candidates.size()},
                             {"rounds", tuningRounds(*tuning).size()},
                             {"estimated_seconds", tuningSeconds(plan, estimate, *tuning)}};
    if (a.json) {
        fmt::print("{}\n", dump(planned));
        return;
    }
    for (const auto& [key, reference] : planned["references"].items())
        fmt::print("reference {}{}\n", key,
                   reference.contains("missing_parts")
                       ? fmt::format("  {} of {} parts of {} are missing, {}", reference["missing_parts"].dump(),
                                     reference["replicates"].dump(), reference["budget"].dump(),
                                     durationText(reference["estimated_seconds"]))
                       : "");
    for (const Json& cell : planned["cells"])
        fmt::print("cell {}  {} replicates of {}, random keys from {}, {}, {}\n", cell["cell"].get<std::string>(),
                   cell["replicates"].dump(), cell["budget"].dump(), cell["random_keys"][0].dump(),
                   durationText(cell["estimated_seconds"]), sizeText(cell["estimated_bytes"]));
    const Cost total = estimate.total(plan);
    fmt::print("{} cells, {} comparisons, about {} and {} without tables and report{}\n", plan.cells.size(), plan.comparisons.size(),
               durationText(total.seconds), sizeText(total.bytes),
               estimate.tried < plan.cells.size() ? fmt::format(" (from trials of {} cells)", estimate.tried) : "");
    if (tuning)
        fmt::print("before that {} is tuned: {} candidates in {} rounds, about {}\n", tuning->sampler,
                   tuning->candidates.size(), tuningRounds(*tuning).size(),
                   durationText(planned["tuning"]["estimated_seconds"]));
    if (plan.until)
        fmt::print("up to {} replicates of a cell until every comparison is decided or known to {:g}\n",
                   plan.until->maxReplicates, plan.until->relativeCi);
    for (const Json& warning : planned["warnings"]) fmt::print(stderr, "warning: {}\n", warning.get<std::string>());
}

void printResults(const Json& summary, const fs::path& runDir, const RunArguments& a) {
    if (a.json) {
        fmt::print("{}\n", dump(summary));
        return;
    }
    for (const Json& warning : summary["warnings"]) fmt::print(stderr, "warning: {}\n", warning.get<std::string>());
    for (const Json& verdict : summary["verdicts"]) fmt::print("{}\n", verdict.get<std::string>());
    fmt::print("{}\n", fs::absolute(runDir / "report.html").lexically_normal().string());
}

constexpr const char* kGoOn = "finished replicates are kept: go on with --resume";

void printJobs(const std::vector<JobArray>& arrays, const fs::path& runDir, const RunArguments& a) {
    if (a.json) {
        Json jobs = Json::array();
        for (const JobArray& array : arrays)
            jobs.push_back({{"job", array.job}, {"kind", array.kind}, {"tasks", array.tasks}, {"replicates", array.replicates}, {"estimated_seconds", array.seconds}});
        fmt::print("{}\n", dump(jobs));
        return;
    }
    for (const JobArray& array : arrays)
        fmt::print("job {}: {}, {} replicates in {} tasks of about {}\n", array.job, array.kind, array.replicates, array.tasks,
                   durationText(array.seconds / double(array.tasks)));
    if (arrays.empty()) fmt::print("nothing is left to submit\n");
    fmt::print("ulam status {} shows what becomes of it; when all is done, this command with --resume in place of --jobs makes the report\n", runDir.string());
}

/// What those who work in jobs are told of the files and limits that this process was told of.
std::vector<std::string> workOptions(const CLI::App& command) {
    std::vector<std::string> options;
    for (const char* name : {"--plugin", "--resource-path"})
        for (const std::string& file : command.get_option(name)->results()) options.insert(options.end(), {name, fs::absolute(file).string()});
    for (const char* name : {"--max-memory", "--lease"})
        for (const std::string& value : command.get_option(name)->results()) options.insert(options.end(), {name, value});
    return options;
}

void runExperiment(const RunArguments& a) {
    if (!a.jobs.empty() && !a.viewer->empty())
        fail(ExitCode::Usage, "--tev shows what this process renders, and with --jobs it renders nothing: leave out one of them");
    JsonDocument document = readExperiment(a.experiment);
    document.applyOverrides(a.assignments);
    const std::optional<Tuning> tuning = plannedTuning(document);
    Plan plan = makePlan(document, a.experiment);
    if (a.dryRun) return printDryRun(plan, tuning, a);

    const auto slurm = a.jobs.empty() ? std::nullopt : std::optional(parseSlurmOptions(a.jobs));
    Progress progress(a.quiet);
    std::optional<TevViewer> viewer;
    if (!a.viewer->empty()) viewer.emplace(*a.viewer, progress);
    RunOptions options;
    options.runDir = a.folder.empty() ? defaultFolder(plan.name, a.resume) : fs::path(a.folder);
    options.threads = *a.threads;
    options.keepGoing = a.keepGoing;
    options.leaseSeconds = *a.lease;
    if (viewer) options.show = [&](const std::string& name, Image image) { viewer->show(name, std::move(image)); };
    makeFolder(options.runDir);
    const FileLock lock = FileLock::claim(options.runDir / "run.lock", options.runDir.string());
    if (!a.resume && fs::exists(options.runDir / "resolved.json"))
        fail(ExitCode::Usage, "{} holds a run already: give --resume to go on with it, or another -o",
             options.runDir.string());

    if (a.resume) removeTemporaries(options.runDir);
    removeTemporaries(referenceCache(), Below::No);
    std::vector<std::string> warnings = planWarnings(plan);
    if (!lock.held())
        warnings.push_back(fmt::format("no lock on {}, where the file system has none: let one process write there",
                                       options.runDir.string()));
    for (const auto& reference : plan.references)
        for (const std::string& warning : reference.scene->warnings)
            warnings.push_back(reference.scene->name + ": " + warning);
    for (const std::string& warning : warnings) progress.message("warning: " + warning);

    Json tuned;
    if (tuning) {
        makeFolder(options.runDir / "tuning");
        const TuningOutcome outcome = tune(document, a.experiment, *tuning, options, watchSignals(), progress);
        if (outcome.interrupted) failIfSignalled(kGoOn);
        plan = makePlan(outcome.experiment, a.experiment);
        plan.experiment.erase("tune");  // experiment.json holds what was chosen, and can be run as it is
        tuned = outcome.record;
    }
    if (slurm) return printJobs(submitMissing(plan, options, *slurm, a.workOptions, progress), options.runDir, a);
    const RunOutcome outcome = runPlan(plan, options, watchSignals(), progress);
    if (outcome.interrupted) failIfSignalled(kGoOn);
    if (outcome.reused > 0)
        progress.message(fmt::format("{} replicates were there already, {} are new", outcome.reused, outcome.rendered));
    progress.clear();
    Progress judging(a.quiet);
    const auto beforeCell = [&](double fraction, const std::string& cell) {
        failIfSignalled(kGoOn);
        judging.update(fraction, "statistics of " + cell);
    };
    Json summary = summarize(plan, options.runDir, outcome.failures, options.threads, beforeCell);
    if (tuning) summary["tuning"] = tuned;
    writeSummary(options.runDir, summary);
    judging.update(1, "report");
    writeReport(options.runDir, summary);
    judging.clear();
    printResults(summary, options.runDir, a);
    if (!outcome.failures.empty()) {
        const std::size_t all = plan.order().size(), done = std::size_t(outcome.rendered + outcome.reused);
        fail(ExitCode::SomeCellsFailed, "{} of {} replicates failed; --resume tries them again", all - done, all);
    }
}

}  // namespace

void addRunCommand(CLI::App& app) {
    auto a = std::make_shared<RunArguments>();
    CLI::App& command = *app.add_subcommand("run", "run an experiment: references, all replicates, statistics, report");
    command.add_option("experiment", a->experiment, "JSON file (see: ulam schema experiment)")
        ->type_name("EXPERIMENT.json")
        ->required();
    command
        .add_option("-o,--output", a->folder,
                    "folder of the run; without it NAME-1, NAME-2, ... in $ULAM_RUNS or in runs/")
        ->type_name("DIR");
    command.add_flag("--resume", a->resume, "go on with a run: what is finished is not done again");
    command.add_flag("--dry-run", a->dryRun, "print cells, seeds, work and estimated time, and stop");
    command.add_option("--set", a->assignments, "change the experiment, e.g. budget.time=1 (repeatable)")
        ->type_name("PATH=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    a->threads = addThreadsOption(command);
    a->lease = addLeaseOption(command);
    addMemoryOption(command);
    command
        .add_option(
            "--jobs", a->jobs,
            "submit what is missing to Slurm and stop: slurm:KEY=VALUE,... with task-minutes and options of sbatch, as "
            "partition=short; with --resume again, and for each look of \"until\"")
        ->type_name("slurm[:KEY=VALUE,...]");
    a->viewer = addViewerOption(command);
    command.add_flag("--keep-going", a->keepGoing,
                     "a replicate or a reference that fails is reported, the others go on");
    command.add_flag("--quiet", a->quiet, "no progress");
    command.add_flag("--json", a->json, "print summary.json (with --dry-run: the plan)");
    addPluginOption(command);
    addResourceOption(command);
    command.callback([a, &command] {
        a->workOptions = workOptions(command);
        runExperiment(*a);
    });
}

}  // namespace ulam
