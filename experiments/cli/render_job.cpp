#include "experiments/cli/render_job.h"

#include "core/base/error.h"
#include "core/config/suggest.h"
#include "experiments/engine/experiment.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

const std::string kFilm = "scene.film.", kScene = "scene.", kSampler = "sampler.";

/// The film is a document of its own, since a scene may not have any: a scene that is nothing but a film.
JsonDocument filmDocument(const std::vector<std::string>& assignments) {
    JsonDocument film = JsonDocument::fromText(
        R"({"type": "scene", "sensor": {"type": "perspective", "film": {"type": "hdrfilm"}}})", "the film");
    for (const std::string& assignment : assignments) {
        const auto [path, text] = splitAssignment(assignment);
        if (path.starts_with(kFilm))
            film.set("sensor.film." + path.substr(kFilm.size()), overrideValue(text), "--set " + assignment);
    }
    return film;
}

/// What the film's document says beyond the type.
Json filmOptions(const JsonDocument& film) {
    Json options = film.json()["sensor"]["film"];
    if (options["type"] == "hdrfilm") options.erase("type");
    return options;
}

/// Hands every `--set` to the document that its first step names.
void assign(const std::vector<std::string>& assignments, JsonDocument& scene, JsonDocument& sampler) {
    for (const std::string& assignment : assignments) {
        const auto [path, text] = splitAssignment(assignment);
        const std::string origin = "--set " + assignment;
        if (path.starts_with(kFilm)) continue;
        if (path.starts_with(kScene))
            scene.set(path.substr(kScene.size()), overrideValue(text), origin);
        else if (path.starts_with(kSampler))
            sampler.set(path.substr(kSampler.size()), overrideValue(text), origin);
        else
            fail(ExitCode::Usage, "expected a path that begins with sampler., scene. or scene.film., found {}",
                 inQuotes(origin));
    }
}

}  // namespace

RenderJob renderJob(const RenderWishes& w) {
    auto [scene, folder, file] = sceneArgument(w.scene, w.options);
    auto [sampler, samplerFolder, samplerFile] = samplerArgument(w.sampler);
    assign(w.assignments, scene, sampler);
    RunIdentity run;
    run.scene = w.scene;
    run.parameters = resolveSampler(sampler.root());
    run.sampler = run.parameters["type"];
    run.seed = w.seed;
    run.key = makeKey(w.seed);
    const Json film = filmOptions(filmDocument(w.assignments));
    std::vector<std::string> inScene;
    for (const std::string& assignment : w.assignments)
        if (assignment.starts_with(kScene) && !assignment.starts_with(kFilm)) inScene.push_back(assignment);
    // A file may be large and stays where it is; what was typed is all there.
    run.source = file ? sceneSource(fs::absolute(*file).string(), folder, film) : sceneSource(scene.json(), folder, film);
    if (file && !inScene.empty()) run.source["set"] = inScene;
    if (!w.options.definitions.empty()) run.source["definitions"] = w.options.definitions;
    if (w.options.lenient) run.source["lenient"] = true;
    return {std::move(scene), std::move(folder), film, std::move(sampler), w.budget, std::move(run)};
}

Scene buildScene(const RenderJob& job, const std::vector<std::string>& assignments) {
    const SceneDescription description = SceneDescription::fromNode(job.scene.root(), job.folder);
    try {
        description.filmSize(job.film);
    } catch (const Error&) {
        SceneDescription::fromNode(filmDocument(assignments).root(), ".").filmSize();
        throw;
    }
    return description.build(job.film);
}

RenderJob jobOf(const JsonNode& repeat) {
    const JsonNode source = repeat.at("scene"), scene = source.at("scene"), sampler = repeat.at("sampler");
    SceneFileOptions options;
    if (const auto lenient = source.find("lenient")) options.lenient = lenient->boolean();
    if (const auto definitions = source.find("definitions"))
        for (const auto& [name, value] : definitions->members()) options.definitions[name] = value.string();
    std::vector<std::string> assignments;
    if (const auto set = source.find("set"))
        for (const JsonNode& assignment : set->elements()) assignments.push_back(assignment.string());

    RenderJob job{.scene = scene.isString() ? readSceneDocument(scene.string(), options)
                                            : JsonDocument::fromText(scene.json().dump(), scene.where()),
                  .folder = source.at("folder").string(),
                  .film = source.at("film").json(),
                  .sampler = JsonDocument::fromText(sampler.json().dump(), sampler.where()),
                  .budget = parseBudget(repeat.at("budget"))};
    assign(assignments, job.scene, job.sampler);
    job.run.source = source.json();
    return job;
}

Repetition repetition(const fs::path& file) {
    const JsonDocument document = JsonDocument::fromFile(file);
    const JsonNode result = document.root();
    Repetition r{.job = jobOf(result.at("repeat")),
                 .sceneHash = result.at("scene_hash").string(),
                 .imageHash = result.at("image_sha256").string(),
                 .version = result.at("program_version").string(),
                 .simd = nullptr};
    if (const auto simd = result.find("simd")) r.simd = simd->json();
    RunIdentity& run = r.job.run;
    run.scene = result.at("scene").string();
    run.sampler = result.at("sampler").string();
    run.parameters = result.at("parameters").json();
    run.seed = result.at("seed").unsignedInteger();
    run.replicate = int(result.at("replicate").integer());
    const auto key = result.at("random_key").elements();
    if (key.size() != 2) result.at("random_key").expected("two numbers");
    run.key = {uint32_t(key[0].unsignedInteger()), uint32_t(key[1].unsignedInteger())};
    return r;
}

}  // namespace ulam
