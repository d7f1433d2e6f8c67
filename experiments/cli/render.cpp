// ulam render: one image.

#include <chrono>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/suggest.h"
#include "experiments/cli/arguments.h"
#include "experiments/cli/commands.h"
#include "experiments/engine/progress.h"
#include "experiments/engine/result.h"
#include "experiments/engine/signals.h"

namespace ulam {
namespace {

struct RenderArguments {
    std::string scene, sampler, output, stats;
    std::vector<std::string> assignments;
    std::optional<double> seconds, spp, mutations, rays;
    std::shared_ptr<std::uint64_t> seed;
    std::shared_ptr<int> threads;
    std::shared_ptr<SceneFileOptions> xml;
    bool quiet = false;
};

/// The film is a document of its own, since a scene may not have any: a scene that is nothing but a film.
JsonDocument emptyFilm() {
    return JsonDocument::fromText(
        R"({"type": "scene", "sensor": {"type": "perspective", "film": {"type": "hdrfilm"}}})", "the film");
}

/// What a film document says beyond emptyFilm().
Json filmOptions(const JsonDocument& film) {
    Json options = film.json()["sensor"]["film"];
    if (options["type"] == "hdrfilm") options.erase("type");
    return options;
}

/// Building a scene takes bare JSON for a film. Where it is refused, the same film inside its document is refused with
/// the `--set` that is to blame.
void checkFilm(const SceneDescription& scene, const JsonDocument& film) {
    try {
        scene.filmSize(filmOptions(film));
    } catch (const Error&) {
        SceneDescription::fromNode(film.root(), ".").filmSize();
        throw;
    }
}

/// Hands every `--set` to the document that its first step names.
void applyAssignments(const std::vector<std::string>& assignments, JsonDocument& scene, JsonDocument& sampler,
                      JsonDocument& film) {
    for (const std::string& assignment : assignments) {
        const auto [path, text] = splitAssignment(assignment);
        const auto below = [&, &path = path](std::string_view prefix) {
            return path.starts_with(prefix) ? std::optional(path.substr(prefix.size())) : std::nullopt;
        };
        const std::string origin = "--set " + assignment;
        if (const auto inFilm = below("scene.film."))
            film.set("sensor.film." + *inFilm, overrideValue(text), origin);
        else if (const auto inScene = below("scene."))
            scene.set(*inScene, overrideValue(text), origin);
        else if (const auto inSampler = below("sampler."))
            sampler.set(*inSampler, overrideValue(text), origin);
        else
            fail(ExitCode::Usage, "expected a path that begins with sampler., scene. or scene.film., found {}",
                 inQuotes(origin));
    }
}

void renderImage(const RenderArguments& a) {
    if (!a.output.ends_with(".exr")) fail(ExitCode::Usage, "expected -o NAME.exr, found {}", inQuotes(a.output));
    if (!a.stats.empty() && isSameFile(a.stats, a.output))
        fail(ExitCode::Usage, "-o and --stats name the same file, {}", inQuotes(a.stats));
    checkWritable(a.output);
    if (!a.stats.empty()) checkWritable(a.stats);

    auto [sceneDocument, sceneFolder] = sceneArgument(a.scene, *a.xml);
    auto [samplerDocument, samplerFolder] = samplerArgument(a.sampler);
    JsonDocument film = emptyFilm();
    applyAssignments(a.assignments, sceneDocument, samplerDocument, film);
    const auto sampler = Registry<Sampler>::instance().create(samplerDocument.root());

    Progress progress(a.quiet);
    const auto start = std::chrono::steady_clock::now();
    const SceneDescription description = SceneDescription::fromNode(sceneDocument.root(), sceneFolder);
    checkFilm(description, film);
    const Scene scene = description.build(filmOptions(film));
    for (const std::string& warning : scene.warnings) progress.message("warning: " + warning);

    RunIdentity run;
    run.scene = a.scene;
    run.sceneHash = scene.hash;
    run.parameters = resolveSampler(samplerDocument.root());
    run.sampler = run.parameters["type"];
    run.seed = *a.seed;
    run.key = makeKey(run.seed);
    run.threads = *a.threads;
    run.setupSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    RenderOptions options;
    options.budget = {a.seconds, a.spp, a.mutations, a.rays};
    options.key = run.key;
    options.threads = run.threads;
    options.progress = [&](double fraction) { progress.update(fraction, run.sampler); };
    options.interrupt = &watchSignals();
    const RenderResult result = render(scene, *sampler, options);
    progress.clear();

    if (result.interrupted && isBlack(result.image))
        failIfSignalled("nothing was found until then, and nothing is written");
    if (!result.interrupted) refuseBlackImage(result);
    for (const std::string& warning : warningsOf(result)) progress.message("warning: " + warning);
    writeExr(a.output, result.image, imageAttributes(run));
    const std::filesystem::path output = a.output;
    for (const auto& [name, image] : result.statistics.extraImages)
        writeExr(output.parent_path() / fmt::format("{}.{}.exr", output.stem().string(), name), image);
    if (!a.stats.empty()) writeFileAtomically(a.stats, dump(resultJson(run, result, scene.features)) + "\n");
    failIfSignalled("the image holds what was done until then");
}

}  // namespace

void addRenderCommand(CLI::App& app) {
    auto a = std::make_shared<RenderArguments>();
    CLI::App& command = *app.add_subcommand("render", "render one image");
    command.add_option("scene", a->scene, "JSON, XML or pbrt file, generator (see: ulam list generators), or JSON")->required();
    a->xml = addSceneFileOptions(command);
    addResourceOption(command);
    command.add_option("--sampler", a->sampler, "name (see: ulam list samplers), JSON file, or JSON")->required();
    command
        .add_option("--set", a->assignments, "sampler.KEY=VALUE, scene.KEY=VALUE or scene.film.KEY=VALUE (repeatable)")
        ->type_name("PATH=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    auto* budget = command.add_option_group("budget", "one or more; the first reached ends the run");
    budget->require_option(1, 0);
    budget->add_option("--time", a->seconds, "seconds")->check(positiveNumber());
    budget->add_option("--spp", a->spp, "samples (of chains: mutations) per pixel")->check(positiveNumber());
    budget->add_option("--mutations", a->mutations, "mutations of Markov chains")->check(positiveNumber());
    budget->add_option("--rays", a->rays, "rays traced")->check(positiveNumber());
    a->seed = addSeedOption(command);
    a->threads = addThreadsOption(command);
    command.add_option("-o,--output", a->output, "image to write")->type_name("OUT.exr")->required();
    command.add_option("--stats", a->stats, "numbers to write, as in a cell's result.json")->type_name("OUT.json");
    command.add_flag("--quiet", a->quiet, "no progress");
    addPluginOption(command);
    command.callback([a] { renderImage(*a); });
}

}  // namespace ulam
