// ulam render: one image.

#include <algorithm>
#include <chrono>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/file_lock.h"
#include "core/config/suggest.h"
#include "experiments/cli/commands.h"
#include "experiments/cli/render_job.h"
#include "experiments/engine/experiment.h"
#include "experiments/engine/progress.h"
#include "experiments/engine/provenance.h"
#include "experiments/engine/signals.h"
#include "experiments/engine/tev.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

struct RenderArguments {
    std::string scene, sampler, output, stats, replay;
    std::vector<std::string> assignments;
    std::optional<double> seconds, spp, mutations, rays;
    std::shared_ptr<std::uint64_t> seed;
    std::shared_ptr<int> threads;
    std::shared_ptr<std::string> viewer;
    std::shared_ptr<SceneFileOptions> xml;
    double checkpointInterval = 30;
    bool resume = false, quiet = false;
};

void checkArguments(const RenderArguments& a) {
    if (!a.output.ends_with(".exr")) fail(ExitCode::Usage, "expected -o NAME.exr, found {}", inQuotes(a.output));
    if (!a.stats.empty() && isSameFile(a.stats, a.output))
        fail(ExitCode::Usage, "-o and --stats name the same file, {}", inQuotes(a.stats));
    const bool budget = a.seconds || a.spp || a.mutations || a.rays;
    if (!a.replay.empty()) {
        if (budget || !a.scene.empty() || !a.sampler.empty() || !a.assignments.empty())
            fail(ExitCode::Usage, "--replay takes scene, sampler, settings and budget from the result: give none of them");
    } else {
        if (a.scene.empty()) fail(ExitCode::Usage, "scene is required: a file, a generator or JSON (or --replay RESULT.json)");
        if (a.sampler.empty()) fail(ExitCode::Usage, "--sampler is required: a name (see: ulam list samplers), a file, or JSON");
        if (!budget) fail(ExitCode::Usage, "a budget is required: --time, --spp, --mutations or --rays");
    }
    checkWritable(a.output);
    if (!a.stats.empty()) checkWritable(a.stats);
}

CheckpointPlan checkpointPlan(const RenderArguments& a, const RenderJob& job) {
    CheckpointPlan plan;
    plan.file = a.output + ".checkpoint";
    plan.identity = {{"program_version", programVersion()},
                     {"scene_hash", job.run.sceneHash},
                     {"sampler", job.sampler.json()["type"]},
                     {"parameters", job.run.parameters},
                     {"budget", budgetJson(job.budget)},
                     {"random_key", {job.run.key.low, job.run.key.high}}};
    plan.interval = a.checkpointInterval;
    plan.resume = a.resume ? Resume::Yes : Resume::No;
    return plan;
}

/// The image of a repetition against the one it repeats.
void checkRepetition(const RenderArguments& a, const Repetition& of, const Image& image) {
    if (imageHash(image) == of.imageHash) return;
    std::string cause = " (was it made with another processor?)";
    if (of.version != programVersion())
        cause = fmt::format(", which version {} made; this is {}", of.version, programVersion());
    else if (!of.simd.is_null() && of.simd != simd())
        cause = fmt::format(", which was made with other vector instructions: {}, here {}", of.simd.dump(), simd().dump());
    fail(ExitCode::VerificationRejected, "the image differs from that of {}{}", a.replay, cause);
}

void renderImage(const RenderArguments& a) {
    checkArguments(a);
    Progress progress(a.quiet);
    std::optional<TevViewer> viewer;
    if (!a.viewer->empty()) viewer.emplace(*a.viewer, progress);
    // Two renders would keep their states in one file. The lock's name is no longer than that of the file.
    std::optional<FileLock> alone;
    if (a.checkpointInterval > 0) alone.emplace(FileLock::claim(a.output + ".lock", a.output, LockFile::Goes));
    if (alone && !alone->held())
        progress.message(fmt::format("warning: {} cannot be locked: let no other render write it", a.output));
    std::optional<Repetition> repeated;
    if (!a.replay.empty()) repeated = repetition(a.replay);
    RenderJob job = repeated ? std::move(repeated->job)
                             : renderJob({a.scene, a.sampler, *a.xml, a.assignments, {a.seconds, a.spp, a.mutations, a.rays}, *a.seed});
    const auto sampler = Registry<Sampler>::instance().create(job.sampler.root());

    const auto start = std::chrono::steady_clock::now();
    const Scene scene = buildScene(job, a.assignments);
    if (repeated && scene.hash != repeated->sceneHash)
        fail(ExitCode::InvalidConfig, "the scene is not the one that {} was rendered from: a file has changed", a.replay);
    for (const std::string& warning : scene.warnings) progress.message("warning: " + warning);

    RunIdentity& run = job.run;
    run.sceneHash = scene.hash;
    run.threads = *a.threads;
    run.setupSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    RenderOptions options;
    options.budget = job.budget;
    options.key = run.key;
    options.threads = run.threads;
    options.progress = [&](double fraction) { progress.update(fraction, run.sampler); };
    options.interrupt = &watchSignals();
    if (viewer) options.preview = PreviewPlan{[&](Image image) { viewer->show(a.output, std::move(image)); }};
    if (a.checkpointInterval > 0) {
        options.checkpoint = checkpointPlan(a, job);
        options.checkpoint->warn = [&](const std::string& trouble) { progress.message("warning: no checkpoint: " + trouble); };
        if (!a.resume && isCheckpointOf(*options.checkpoint))
            progress.message(fmt::format("warning: {} holds the state of this very run, which starts anew without --resume",
                                         options.checkpoint->file.string()));
    }
    if (a.resume && !(options.checkpoint && fs::exists(options.checkpoint->file)))
        progress.message("nothing to resume: the run starts anew");
    const RenderResult result = render(scene, *sampler, options);
    progress.clear();

    const std::string after = !options.checkpoint    ? ""
                              : result.lost.empty() ? fmt::format("; --resume goes on from {}", options.checkpoint->file.string())
                                                    : "; it cannot be resumed: " + result.lost;
    if (result.interrupted && isBlack(result.image)) failIfSignalled("nothing was found until then, and no image is written" + after);
    if (!result.interrupted) refuseBlackImage(run, result);
    for (const std::string& warning : warningsOf(run, result)) progress.message("warning: " + warning);
    for (const std::string& bias : result.statistics.biasLedger)
        if (std::ranges::find(scene.substitutions, bias) == scene.substitutions.end())
            progress.message("warning: the image is biased: " + bias);
    const fs::path output = a.output;
    const FileLock together = FileLock::await(output.parent_path());  // of renders with one name, the files of one win
    removeTemporaries(output.parent_path().empty() ? "." : output.parent_path(), Below::No);
    writeExr(a.output, result.image, imageAttributes(run));
    for (const auto& [name, image] : result.statistics.extraImages)
        writeExr(output.parent_path() / fmt::format("{}.{}.exr", output.stem().string(), name), image);
    if (!a.stats.empty()) writeFileAtomically(a.stats, dump(resultJson(run, result, scene.features)) + "\n");
    if (result.interrupted) failIfSignalled("the image holds what was done until then" + after);
    std::error_code ignored;
    if (options.checkpoint) fs::remove(options.checkpoint->file, ignored);
    if (repeated) checkRepetition(a, *repeated, result.image);
}

}  // namespace

void addRenderCommand(CLI::App& app) {
    auto a = std::make_shared<RenderArguments>();
    CLI::App& command = *app.add_subcommand("render", "render one image");
    command.add_option("scene", a->scene, "JSON, XML or pbrt file, generator (see: ulam list generators), or JSON");
    a->xml = addSceneFileOptions(command);
    addResourceOption(command);
    command.add_option("--sampler", a->sampler, "name (see: ulam list samplers), JSON file, or JSON");
    command
        .add_option("--set", a->assignments, "sampler.KEY=VALUE, scene.KEY=VALUE or scene.film.KEY=VALUE (repeatable)")
        ->type_name("PATH=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    auto* budget = command.add_option_group("budget", "one or more; the first reached ends the run");
    budget->add_option("--time", a->seconds, "seconds")->check(positiveNumber());
    budget->add_option("--spp", a->spp, "samples (of chains: mutations) per pixel")->check(positiveNumber());
    budget->add_option("--mutations", a->mutations, "mutations of Markov chains")->check(positiveNumber());
    budget->add_option("--rays", a->rays, "rays traced")->check(positiveNumber());
    a->seed = addSeedOption(command);
    a->threads = addThreadsOption(command);
    addMemoryOption(command);
    a->viewer = addViewerOption(command);
    command.add_option("-o,--output", a->output, "image to write")->type_name("OUT.exr")->required();
    command.add_option("--stats", a->stats, "numbers to write, as in a cell's result.json")->type_name("OUT.json");
    command.add_option("--replay", a->replay, "repeat the run of a result.json by the work it did, and check that the image is the same")
        ->type_name("RESULT.json");
    command.add_option("--checkpoint", a->checkpointInterval, "seconds after which the state is kept in OUT.exr.checkpoint; 0: never")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command.add_flag("--resume", a->resume, "go on from OUT.exr.checkpoint where it is there");
    command.add_flag("--quiet", a->quiet, "no progress");
    addPluginOption(command);
    command.callback([a] { renderImage(*a); });
}

}  // namespace ulam
