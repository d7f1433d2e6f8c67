#pragma once
// An experiment as users write it: keys, defaults and checks. Every key is described here once; the parser, its error
// messages and the JSON Schema come from the descriptions.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/json.h"
#include "core/config/parameters.h"
#include "core/render/driver.h"

namespace ulam {

/// Limits of a run; the first reached ends it. 0 stands for none, and cannot be written.
struct BudgetParameters {
    double time = 0, spp = 0, mutations = 0, rays = 0;

    template <class V>
    void describe(V& v) {
        v("time", time,
          {.help = "wall time of the render phase, seeding included", .unit = "seconds", .min = 0, .example = "10"});
        v("spp", spp, {.help = "samples per pixel (of chains: mutations per pixel)", .min = 0, .example = "64"});
        v("mutations", mutations,
          {.help = "mutations of all chains; for samplers with chains only", .min = 0, .example = "1000000"});
        v("rays", rays, {.help = "rays traced", .min = 0, .example = "10000000"});
    }
};

struct ReferenceParameters {
    JsonNode sampler, budget, part;
    std::string image, variance;

    template <class V>
    void describe(V& v) {
        v("sampler", sampler,
          {.help = "sampler that makes the reference: a registered name, a name in samplers, or parameters",
           .example = R"("bdpt")"});
        v("budget", budget,
          {.help = "of all parts of the reference together, rounded up to an even number of at least 4; more extends it",
           .example = R"({"spp": 16384})"});
        v("part", part,
          {.help = "what each of the independent parts may spend, by the same limits as the budget; without it "
                   "64 samples or mutations a pixel, 640 rays a pixel, 2 s",
           .example = R"({"spp": 64})"});
        v("image", image,
          {.help = "EXR file to take instead, relative to the experiment", .example = R"("references/plate.exr")"});
        v("variance", variance,
          {.help = "EXR file with the variance of that image's pixels; NAME.variance.exr where not given",
           .example = R"("references/plate.variance.exr")"});
    }
};

/// When to stop adding replicates.
struct UntilParameters {
    double relativeCi = 0.05;
    int maxReplicates = 128;

    template <class V>
    void describe(V& v) {
        v("relative_ci", relativeCi,
          {.help = "half the width of the interval of a ratio, or of a mean error where nothing is compared, over the value",
           .min = 1e-4,
           .max = 1});
        v("max_replicates", maxReplicates, {.help = "of each cell", .min = 2, .max = 10000});
    }
};

/// Parameters of one sampler to try before it is compared.
struct TuneParameters {
    JsonNode sweep;
    int reduction = 3, replicates = 4;

    template <class V>
    void describe(V& v) {
        v("sweep", sweep,
          {.help = "the candidates: values of parameters of one sampler, as in the experiment's sweep",
           .example = R"({"samplers.mlt.mutations.lens.weight": [0.5, 1, 2]})"});
        v("reduction", reduction, {.help = "after each round the best 1 / reduction go on, with that many times the budget", .min = 2, .max = 16});
        v("replicates", replicates, {.help = "runs of each candidate on each scene in a round", .min = 1, .max = 1000});
    }
};

struct ExperimentParameters {
    std::string schema, name;
    JsonNode extends, scene, scenes, film;
    int maxDepth = 8;
    JsonNode samplers;
    std::string baseline;
    JsonNode budget;
    int replicates = 16;
    std::uint64_t seed = 1;
    JsonNode until;
    bool commonRandomNumbers = false;
    int snapshots = 6;
    JsonNode metrics{Json{"relmse", "mape", "flip"}};
    JsonNode reference, tune, sweep;

    template <class V>
    void describe(V& v) {
        v("$schema", schema, {.help = "JSON Schema for editors; not read", .example = R"("experiment.schema.json")"});
        v("name", name, {.help = "of the run; that of the file where not given", .example = R"("holes")"});
        v("extends", extends,
          {.help = "file, or list of files, in the same folder that this one adds to and changes",
           .example = R"("base.json")"});
        v("scene", scene,
          {.help = "the only scene: a dictionary, a generator, or a file relative to the experiment",
           .example = R"({"type": "grid_of_holes", "open_area": 0.001})"});
        v("scenes", scenes,
          {.help = "scenes by name, each as under scene",
           .example = R"({"plate": {"type": "grid_of_holes"}, "box": "scenes/box.json"})"});
        v("film", film,
          {.help = "width, height, crop_* and rfilter, for all scenes", .example = R"({"width": 320, "height": 180})"});
        v("max_depth", maxDepth,
          {.help = "longest path in edges, for all samplers and the reference; 1 = emitters seen directly", .min = 1});
        v("samplers", samplers,
          {.help = "samplers by name, each with its type and parameters",
           .example = R"({"mlt": {"type": "mlt", "chains": 100}, "bdpt": {"type": "bdpt"}})"});
        v("baseline", baseline,
          {.help = "sampler that the others are compared with; none: no comparisons", .example = R"("bdpt")"});
        v("budget", budget, {.help = "what each replicate may spend", .example = R"({"time": 10})"});
        v("replicates", replicates, {.help = "independent runs of each sampler on each scene", .min = 1, .max = 10000});
        v("until", until,
          {.help = "add replicates until every comparison is decided, or its ratio is known to \"relative_ci\"",
           .example = R"({"relative_ci": 0.05, "max_replicates": 128})"});
        v("seed", seed, {.help = "master seed"});
        v("common_random_numbers", commonRandomNumbers,
          {.help = "replicates of one number share their random numbers in all cells; comparisons are then of pairs"});
        v("snapshots", snapshots,
          {.help = "images at 1/2, 1/4, ... of the budget, for convergence", .min = 0, .max = 20});
        v("metrics", metrics, {.help = "error metrics; the first is primary and carries the verdict"});
        v("reference", reference,
          {.help = "\"truth\", an EXR file, or a sampler with its budget; or each of these by scene",
           .example = R"({"sampler": "bdpt", "budget": {"spp": 16384}})"});
        v("tune", tune,
          {.help = "choose a sampler's parameters by successive halving before it is compared",
           .example = R"({"sweep": {"samplers.mlt.chains": [10, 100, 1000]}})"});
        v("sweep", sweep,
          {.help = "values by path into the experiment; several paths make a grid",
           .example = R"({"scene.open_area": {"log": [0.0001, 0.1], "steps": 4}})"});
    }
};

struct ReferenceSpec {
    enum class Kind { Sampler, Truth, File } kind = Kind::Sampler;
    Json parameters;  ///< of the sampler, resolved
    Budget budget;    ///< of all parts together, but for rounding
    std::optional<Budget> part;  ///< what each may spend, of the same limits; none: the usual one
    std::filesystem::path image, variance;
    std::string where;  ///< in the experiment, for messages
};

struct NamedScene {
    std::string name;
    JsonNode node;
    ReferenceSpec reference;
};

struct NamedSampler {
    std::string name;
    Json parameters;  ///< "type" and every parameter, max_depth included
    bool chains;      ///< are its units mutations?
};

/// A checked experiment without its sweep: one point of it.
struct Experiment {
    std::string name;
    std::filesystem::path folder;  ///< relative paths start here
    std::vector<NamedScene> scenes;
    Json film;
    int maxDepth;
    std::vector<NamedSampler> samplers;
    std::string baseline;
    Budget budget;
    int replicates;
    std::uint64_t seed;
    std::optional<UntilParameters> until;
    bool commonRandomNumbers;
    int snapshots;
    std::vector<std::string> metrics;
};

/// Checks everything except what needs a scene to be built. Fails with InvalidConfig and the place.
Experiment parseExperiment(const JsonNode& root, const std::filesystem::path& folder, const std::string& defaultName);

Budget parseBudget(const JsonNode& node);
/// The limits that are set.
Json budgetJson(const Budget& budget);

/// JSON Schema (draft 7) of an experiment, with what is registered in the program.
Json experimentSchema();

}  // namespace ulam
