#include "experiments/engine/plan.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "core/base/error.h"
#include "core/base/sha256.h"
#include "experiments/engine/provenance.h"
#include "experiments/engine/result.h"
#include "experiments/statistics/comparison.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

/// References do not depend on an experiment's seed, so that experiments can share them.
constexpr std::uint64_t kReferenceSeed = 0x7265666572656e63;

/// Parts of a reference: two in each half at least, and no more than a folder of replicates may have.
constexpr double kFewestParts = 4, kMostParts = 10'000;

/// What a part of a reference may spend where the experiment does not say. It does not depend on the whole budget, so
/// that a larger one means more of the same parts.
Budget usualPart(const Budget& whole, const FilmSize& film) {
    constexpr double kSeconds = 2, kUnitsAPixel = 64, kRaysAPixel = 640;
    const double pixels = double(film.cropWidth) * film.cropHeight;
    Budget part;
    if (whole.seconds) part.seconds = kSeconds;
    if (whole.spp) part.spp = kUnitsAPixel;
    if (whole.mutations) part.mutations = kUnitsAPixel * pixels;
    if (whole.rays) part.rays = kRaysAPixel * pixels;
    return part;
}

/// How many parts spend the budget of a reference, the first limit that they reach, or a little more: halves are equal.
int partsOf(const ReferenceSpec& spec, const Budget& part) {
    double parts = std::numeric_limits<double>::infinity();
    for (const auto limit : {&Budget::seconds, &Budget::spp, &Budget::mutations, &Budget::rays})
        if (part.*limit) parts = std::min(parts, *(spec.budget.*limit) / *(part.*limit));
    parts = std::max(kFewestParts,
                     2 * std::ceil(parts / 2 * (1 - 1e-12)));  // a quotient of decimals may be off by a rounding
    if (parts > kMostParts)
        fail(ExitCode::InvalidConfig,
             "the reference at {} consists of {:g} parts of {}, expected at most {}; give larger ones in \"part\"",
             spec.where, parts, budgetJson(part).dump(), kMostParts);
    return static_cast<int>(parts);
}

/// How often the number of replicates can double before it reaches the most, the first look included.
int looks(int replicates, int most) {
    return replicates >= most ? 1 : 1 + looks(2 * replicates, most);
}

std::string sweptOrigin(const SweepValue& value) {
    return fmt::format("sweep {}={}", value.path, value.value.dump());
}

/// Of a cell's folder. File systems take names of up to 255 bytes.
std::string cellName(const std::string& scene, const std::string& sampler, const std::vector<SweepValue>& values) {
    constexpr std::size_t kLongest = 200;
    std::string name = fmt::format("{}-{}", scene, sampler), shorter = name;
    for (const SweepValue& value : values) {
        name += "," + value.label;
        shorter += "," + value.shortLabel;
    }
    if (name.size() <= kLongest) return name;
    if (shorter.size() <= kLongest) return shorter;
    const std::string end = ",hash=" + sha256(name).substr(0, 16);
    return shorter.substr(0, shorter.rfind(',', kLongest - end.size())) + end;
}

class Planner {
public:
    Planner(const JsonDocument& document, const fs::path& file) : document_(document), file_(file) {}

    Plan make() {
        const JsonNode root = document_.root();
        plan_.experiment = root.json();
        plan_.source = fs::absolute(file_).lexically_normal().string();  // for those who plan again elsewhere
        const std::optional<JsonNode> sweep = root.isObject() ? root.find("sweep") : std::nullopt;
        if (sweep) openScenes(*sweep);
        const std::vector<SweepPoint> points = sweep ? expandSweep(*sweep, document_.root()) : std::vector<SweepPoint>(1);
        for (const SweepPoint& point : points) addPoint(point);
        return std::move(plan_);
    }

private:
    /// Where a sweep leads into a scene that is a file, what is in the file takes the place of its name.
    void openScenes(const JsonNode& sweep) {
        if (!sweep.isObject()) return;
        for (const auto& [path, values] : sweep.members()) {
            if (path == "zip") openScenes(values);
            const std::vector<std::string> steps = pathSteps(path);
            const std::size_t depth = steps[0] == "scene" ? 1 : 2;
            if ((steps[0] != "scene" && steps[0] != "scenes") || steps.size() <= depth) continue;
            std::optional<JsonNode> scene = document_.root().find(steps[0]);
            if (scene && depth == 2) scene = scene->isObject() ? scene->find(steps[1]) : std::nullopt;
            if (!scene || !scene->isString()) continue;
            const fs::path file = file_.parent_path() / scene->string();
            const JsonDocument content = readSceneDocument(file);
            if (!content.json().is_object()) content.root().expected("a scene or a generator, an object with a \"type\"");
            folders_[steps[depth - 1]] = file.parent_path();
            document_.set(depth == 1 ? "scene" : "scenes." + steps[1], content.json(), file.string());
        }
    }

    void addPoint(const SweepPoint& point) {
        JsonDocument document = document_;
        for (const SweepValue& value : point) document.set(value.path, value.value, sweptOrigin(value));
        const Experiment e = parseExperiment(document.root(), file_.parent_path(), file_.stem().string());
        plan_.name = e.name;
        plan_.metrics = e.metrics;
        plan_.seed = e.seed;
        plan_.until = e.until;
        plan_.design.paired = e.commonRandomNumbers;
        if (e.until) plan_.design.looks = std::max(plan_.design.looks, looks(e.replicates, e.until->maxReplicates));
        for (const NamedScene& scene : e.scenes) {
            const auto planned = plannedScene(scene, e);
            const std::size_t reference = referenceFor(scene.reference, planned, e);
            std::vector<std::size_t> indices;
            for (const NamedSampler& sampler : e.samplers)
                indices.push_back(cellFor(point, planned, sampler, reference, e));
            for (std::size_t i = 0; i < indices.size(); ++i)
                for (std::size_t b = 0; b < indices.size(); ++b)
                    if (e.samplers[b].name == e.baseline && b != i) addComparison({indices[i], indices[b]});
        }
    }

    std::shared_ptr<const PlannedScene> plannedScene(const NamedScene& scene, const Experiment& e) {
        const std::string key = scene.name + scene.node.json().dump() + e.film.dump();
        auto& known = scenes_[key];
        if (known) return known;
        const auto start = std::chrono::steady_clock::now();
        const auto opened = folders_.find(scene.name);
        const fs::path folder = opened == folders_.end() ? e.folder : opened->second;
        const SceneDescription description = SceneDescription::fromNode(scene.node, folder);
        auto planned = std::make_shared<PlannedScene>();
        planned->name = scene.name;
        planned->film = e.film;
        planned->source = sceneSource(scene.node.isString() ? Json(fs::absolute(e.folder / scene.node.string()).string()) : scene.node.json(),
                                      description.folder(), e.film);
        planned->description = scene.node.isString() ? description.dictionary() : scene.node.json();
        if (description.generator()) {
            planned->generator = description.generator();
            if (scene.node.isObject()) {
                const JsonNode type = scene.node.at("type");
                planned->description.update(
                    Registry<Generator>::instance().find(type.string(), type).resolve(scene.node));
            }
        }
        planned->filmSize = description.filmSize(e.film);
        planned->build = [node = scene.node, folder, film = e.film] {
            return SceneDescription::fromNode(node, folder).build(film);
        };
        const auto built = newScene([&] { return description.build(e.film); });
        planned->setupSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        planned->hash = built->hash;
        planned->filter = built->filter;
        planned->features = built->features;
        planned->warnings = built->warnings;
        planned->substitutions = built->substitutions;
        return known = planned;
    }

    std::size_t referenceFor(const ReferenceSpec& spec, const std::shared_ptr<const PlannedScene>& scene,
                             const Experiment& e) {
        PlannedReference reference{"", spec, scene, {}};
        Json identity = {{"scene", scene->hash}};
        std::string kind;
        switch (spec.kind) {
            case ReferenceSpec::Kind::Truth:
                if (!scene->generator || !scene->generator->truth({8, 8, 0, 0, 8, 8}))
                    fail(ExitCode::InvalidConfig, "no closed form of the image of scene {} is known at {}", scene->name,
                         spec.where);
                if (scene->filter.type() != ReconstructionFilter::Type::Box)
                    fail(ExitCode::InvalidConfig,
                         "the truth at {} is known for the box filter only; set \"rfilter\": {{\"type\": \"box\"}} in "
                         "\"film\"",
                         spec.where);
                kind = "truth";
                break;
            case ReferenceSpec::Kind::File:
                kind = "file";
                identity["image"] = sha256OfFile(spec.image.string());
                identity["variance"] = sha256OfFile(spec.variance.string());
                break;
            case ReferenceSpec::Kind::Sampler: {
                Task& task = reference.task;
                task.scene = scene;
                task.sampler = kind = spec.parameters["type"].get<std::string>();
                task.parameters = spec.parameters;
                task.budget = spec.part ? *spec.part : usualPart(spec.budget, scene->filmSize);
                task.replicates = partsOf(spec, task.budget);
                task.maxDepth = e.maxDepth;
                task.seed = kReferenceSeed;
                identity["task"] = task.hash();
                identity["program"] = codeHash();  // another build may have another bug
                break;
            }
        }
        reference.key = fmt::format("{}-{}", kind, sha256(identity.dump()).substr(0, 16));
        reference.task.name = reference.task.stream = reference.key;
        for (std::size_t i = 0; i < plan_.references.size(); ++i) {
            PlannedReference& known = plan_.references[i];
            if (known.key != reference.key) continue;
            known.task.replicates = std::max(known.task.replicates, reference.task.replicates);
            return i;
        }
        plan_.references.push_back(std::move(reference));
        return plan_.references.size() - 1;
    }

    std::size_t cellFor(const SweepPoint& point, const std::shared_ptr<const PlannedScene>& scene,
                        const NamedSampler& sampler, std::size_t reference, const Experiment& e) {
        Cell cell;
        cell.reference = reference;
        Task& task = cell.task;
        std::vector<SweepValue> own;
        for (const SweepValue& value : point)
            if (affects(value, scene->name, sampler.name)) own.push_back(value);
        for (const SweepValue& value : own) cell.sweep[value.path] = value.value;
        task.name = cellName(scene->name, sampler.name, own);
        task.stream = e.commonRandomNumbers ? "common random numbers" : task.name;
        task.scene = scene;
        task.sampler = sampler.name;
        task.parameters = sampler.parameters;
        task.budget = e.budget;
        task.maxDepth = e.maxDepth;
        task.replicates = e.replicates;
        task.snapshots = e.snapshots;
        task.seed = e.seed;
        const auto [known, added] = cells_.try_emplace(task.name, plan_.cells.size());
        if (added) plan_.cells.push_back(std::move(cell));
        return known->second;
    }

    void addComparison(PlannedComparison comparison) {
        if (compared_.emplace(comparison.cell, comparison.baseline).second) plan_.comparisons.push_back(comparison);
    }

    JsonDocument document_;
    const fs::path& file_;
    Plan plan_;
    std::map<std::string, fs::path> folders_;  ///< of scenes that were opened, where relative names in them start
    std::map<std::string, std::shared_ptr<const PlannedScene>> scenes_;
    std::map<std::string, std::size_t> cells_;
    std::set<std::pair<std::size_t, std::size_t>> compared_;
};

Json taskJson(const Task& task) {
    Json keys = Json::array();
    for (int r = 0; r < task.replicates; ++r) keys.push_back({task.key(r).low, task.key(r).high});
    return {{"scene", task.scene->name},      {"scene_hash", task.scene->hash},    {"sampler", task.sampler},
            {"parameters", task.parameters},  {"budget", budgetJson(task.budget)}, {"max_depth", task.maxDepth},
            {"replicates", task.replicates},  {"snapshots", task.snapshots},       {"seed", task.seed},
            {"random_keys", std::move(keys)}, {"task_hash", task.hash()}};
}

}  // namespace

RandomKey Task::key(int replicate) const {
    return makeKey(seed, hash64(stream), static_cast<std::uint64_t>(replicate));
}

std::string Task::hash() const {
    return sha256(Json{{"stream", stream},
                       {"scene", scene->hash},
                       {"parameters", parameters},
                       {"budget", budgetJson(budget)},
                       {"max_depth", maxDepth},
                       {"snapshots", snapshots},
                       {"seed", seed},
                       {"version", programVersion()}}
                      .dump());
}

std::vector<Plan::Replicate> Plan::order(const std::vector<int>& done) const {
    std::vector<Replicate> all;
    const auto first = [&](std::size_t c) { return done.empty() ? 0 : done[c]; };
    int blocks = 0;
    for (const Cell& cell : cells) blocks = std::max(blocks, cell.task.replicates);
    for (int block = 0; block < blocks; ++block) {
        const auto begin = static_cast<std::ptrdiff_t>(all.size());
        for (std::size_t c = 0; c < cells.size(); ++c)
            if (block >= first(c) && block < cells[c].task.replicates) all.push_back({c, block});
        Random random(makeKey(seed, hash64("order of the cells")), 0, static_cast<std::uint64_t>(block));
        for (auto n = static_cast<std::ptrdiff_t>(all.size()) - begin; n > 1; --n)
            std::swap(all[static_cast<std::size_t>(begin + n - 1)],
                      all[static_cast<std::size_t>(begin + random.index(static_cast<int>(n)))]);
    }
    return all;
}

std::vector<int> Plan::replicatesOfCells() const {
    std::vector<int> counts;
    for (const Cell& cell : cells) counts.push_back(cell.task.replicates);
    return counts;
}

std::vector<double> Plan::smallestAdjustedP() const {
    std::vector<std::pair<std::size_t, std::size_t>> sizes;
    const auto most = [&](std::size_t cell) { return until ? until->maxReplicates : cells[cell].task.replicates; };
    for (const PlannedComparison& c : comparisons) sizes.emplace_back(most(c.cell), most(c.baseline));
    return statistics::smallestAdjustedP(sizes, design);
}

Json Plan::resolved() const {
    Json referencesJson = Json::object(), cellsJson = Json::array(), scenesJson = Json::object(),
         comparisonsJson = Json::array();
    for (const PlannedReference& reference : references) {
        Json& json = referencesJson[reference.key];
        switch (reference.spec.kind) {
            case ReferenceSpec::Kind::Sampler:
                json = taskJson(reference.task);
                break;
            case ReferenceSpec::Kind::Truth:
                json = {{"truth", true}, {"scene", reference.scene->name}};
                break;
            case ReferenceSpec::Kind::File:
                json = {{"image", reference.spec.image.string()}, {"variance", reference.spec.variance.string()}};
                break;
        }
    }
    for (const Cell& cell : cells) {
        Json json = {{"cell", cell.task.name}};
        json.update(taskJson(cell.task));
        json["sweep"] = cell.sweep;
        json["reference"] = references[cell.reference].key;
        cellsJson.push_back(std::move(json));
        const PlannedScene& scene = *cell.task.scene;
        scenesJson[scene.hash] = {{"name", scene.name},
                                  {"description", scene.description},
                                  {"film", scene.film},
                                  {"width", scene.filmSize.cropWidth},
                                  {"height", scene.filmSize.cropHeight}};
    }
    for (const PlannedComparison& c : comparisons)
        comparisonsJson.push_back({{"cell", cells[c.cell].task.name}, {"baseline", cells[c.baseline].task.name}});
    return {{"schema_version", 1},
            {"name", name},
            {"source", source},
            {"seed", seed},
            {"metrics", metrics},
            {"common_random_numbers", design.paired},
            {"looks", design.looks},
            {"scenes", scenesJson},
            {"references", referencesJson},
            {"cells", cellsJson},
            {"comparisons", comparisonsJson}};
}

Plan makePlan(const JsonDocument& document, const fs::path& file) {
    return Planner(document, file).make();
}

}  // namespace ulam
