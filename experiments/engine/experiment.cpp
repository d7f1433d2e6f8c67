#include "experiments/engine/experiment.h"

#include <algorithm>
#include <cctype>

#include "core/config/suggest.h"
#include "core/image/metrics.h"
#include "core/scene/plugins.h"
#include "experiments/engine/result.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

/// A name that becomes a part of a folder's name.
void checkName(const JsonNode& node, const std::string& name) {
    const auto allowed = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '+'; };
    if (name.empty() || name.size() > 64 || !std::all_of(name.begin(), name.end(), allowed))
        node.fail(fmt::format("expected a name of at most 64 letters, digits, \"_\", \"-\" and \"+\", found {}",
                              inQuotes(name)));
}

/// A scene's film may have options of Mitsuba that mean nothing here; in an experiment they are mistakes. The values are
/// checked when a scene is built.
void checkFilm(const JsonNode& film) {
    if (!film.isObject()) film.expected("an object with width and height");
    const PluginInfo plugin = scenePlugins(PluginKind::Films).front();
    std::vector<std::string> names{"type"};
    for (const ParameterInfo& parameter : plugin.parameters) names.push_back(parameter.name);
    film.allowOnly("film option", names);
    if (const auto type = film.find("type"); type && type->string() != plugin.name) unknownName("film", type->string(), {plugin.name}, type->where());
}

/// The sampler's parameters with the depth that all share.
Json shareDepth(const JsonNode& sampler, int maxDepth) {
    Json parameters = resolveSampler(sampler);
    if (!parameters.contains("max_depth")) return parameters;
    if (const auto own = sampler.find("max_depth"))
        own->fail("max_depth is the same for all samplers and the reference", "set it beside \"film\"");
    parameters["max_depth"] = maxDepth;
    return parameters;
}

NamedSampler parseSampler(const std::string& name, const JsonNode& node, int maxDepth) {
    checkName(node, name);
    // Made twice: from the text for errors with a place, then with everything in it.
    Registry<Sampler>::instance().create(node);
    NamedSampler sampler{name, shareDepth(node, maxDepth), false};
    sampler.chains = Registry<Sampler>::instance().create(JsonNode(sampler.parameters))->isChainSampler();
    return sampler;
}

class ReferenceReader {
public:
    explicit ReferenceReader(const Experiment& experiment) : experiment_(experiment) {}

    ReferenceSpec read(const JsonNode& node) const {
        ReferenceSpec spec;
        spec.where = node.where();
        if (node.isString()) {
            if (node.string() == "truth")
                spec.kind = ReferenceSpec::Kind::Truth;
            else
                readFile(node, node.string(), "", spec);
            return spec;
        }
        if (!node.isObject()) node.expected("\"truth\", an EXR file, or an object with a sampler and a budget");
        const auto p = parseParameters<ReferenceParameters>(node, {});
        if (node.find("image")) {
            for (const char* key : {"sampler", "budget", "part"})
                if (const auto other = node.find(key))
                    other->fail("a reference is either an image or made by a sampler");
            readFile(node.at("image"), p.image, p.variance, spec);
            return spec;
        }
        if (const auto variance = node.find("variance")) variance->fail("a variance belongs to an image");
        spec.kind = ReferenceSpec::Kind::Sampler;
        node.at("sampler"), node.at("budget");
        const NamedSampler sampler = namedSampler(p.sampler);
        spec.parameters = sampler.parameters;
        spec.budget = parseBudget(p.budget);
        if (spec.budget.mutations && !sampler.chains)
            p.budget.at("mutations").fail("the reference's sampler has no chains");
        if (node.find("part")) {
            spec.part = parseBudget(p.part);
            for (const auto& [one, other] : {std::pair(p.part, p.budget), std::pair(p.budget, p.part)})
                for (const auto& [limit, value] : one.members())
                    if (!other.find(limit))
                        p.part.fail("a part of a reference has other limits than its budget", "give both the same");
        }
        return spec;
    }

    /// One for all scenes, or an object of one for each.
    ReferenceSpec forScene(const JsonNode& node, const std::string& scene) const {
        if (!node.isObject() || node.find("sampler") || node.find("budget") || node.find("image")) return read(node);
        std::vector<std::string> names;
        for (const NamedScene& s : experiment_.scenes) names.push_back(s.name);
        node.allowOnly("scene", names);
        return read(node.at(scene));
    }

private:
    void readFile(const JsonNode& node, const std::string& image, const std::string& variance,
                  ReferenceSpec& spec) const {
        spec.kind = ReferenceSpec::Kind::File;
        if (!image.ends_with(".exr")) node.expected("\"truth\" or a file that ends in .exr");
        spec.image = experiment_.folder / image;
        spec.variance =
            variance.empty() ? fs::path(spec.image).replace_extension(".variance.exr") : experiment_.folder / variance;
        for (const fs::path& file : {spec.image, spec.variance})
            if (!fs::exists(file))
                fail(ExitCode::InputMissing, "the reference {} at {} does not exist", file.string(), node.where());
    }

    /// A registered name comes first: the reference stays the same while a sweep changes the sampler it judges.
    NamedSampler namedSampler(const JsonNode& node) const {
        if (node.isObject()) return parseSampler("reference", node, experiment_.maxDepth);
        if (!node.isString()) node.expected("the name of a sampler, or an object with its type and parameters");
        const std::string& name = node.string();
        if (Registry<Sampler>::instance().contains(name))
            return parseSampler("reference", JsonNode(Json{{"type", name}}), experiment_.maxDepth);
        std::vector<std::string> known = Registry<Sampler>::instance().names();
        for (const NamedSampler& sampler : experiment_.samplers) {
            if (sampler.name == name) return sampler;
            known.push_back(sampler.name);
        }
        unknownName("sampler", name, known, node.where());
    }

    const Experiment& experiment_;
};

std::vector<std::string> parseMetrics(const JsonNode& node) {
    std::vector<std::string> names, known;
    for (const Metric& metric : ulam::metrics()) known.emplace_back(metric.name);
    for (const JsonNode& element : node.elements()) {
        const std::string& name = element.string();
        if (std::find(known.begin(), known.end(), name) == known.end())
            unknownName("metric", name, known, element.where());
        if (std::find(names.begin(), names.end(), name) != names.end())
            element.fail(fmt::format("the metric {} stands here twice", name));
        names.push_back(name);
    }
    if (names.empty()) node.expected("at least one metric");
    if (findMetric(names.front()).higherIsBetter)
        node[0].fail(fmt::format("{} cannot be the primary metric, which must be an error", names.front()),
                     "put another one first");
    return names;
}

UntilParameters parseUntil(const JsonNode& node, int replicates) {
    const auto until = parseParameters<UntilParameters>(node, {});
    if (replicates < 2) node.fail("intervals need \"replicates\" of at least 2 to start with");
    if (until.maxReplicates < replicates)
        node.find("max_replicates").value_or(node).expected(fmt::format("at least the {} \"replicates\"", replicates));
    return until;
}

}  // namespace

Budget parseBudget(const JsonNode& node) {
    const auto p = parseParameters<BudgetParameters>(node, {});
    Budget budget;
    const auto limit = [&](const char* key, double value, std::optional<double>& target) {
        const auto written = node.find(key);
        if (!written) return;
        if (value <= 0) written->expected("a number above 0");
        target = value;
    };
    limit("time", p.time, budget.seconds);
    limit("spp", p.spp, budget.spp);
    limit("mutations", p.mutations, budget.mutations);
    limit("rays", p.rays, budget.rays);
    if (node.size() == 0) node.expected("at least one of time, spp, mutations and rays");
    return budget;
}

Json budgetJson(const Budget& budget) {
    Json json = Json::object();
    if (budget.seconds) json["time"] = *budget.seconds;
    if (budget.spp) json["spp"] = *budget.spp;
    if (budget.mutations) json["mutations"] = *budget.mutations;
    if (budget.rays) json["rays"] = *budget.rays;
    return json;
}

Experiment parseExperiment(const JsonNode& root, const fs::path& folder, const std::string& defaultName) {
    if (!root.isObject()) root.expected("an experiment: an object");
    const auto p = parseParameters<ExperimentParameters>(root, {});
    if (!p.extends.isNull()) p.extends.fail("\"extends\" is read in a file only");
    Experiment e;
    e.name = p.name.empty() ? defaultName : p.name;
    checkName(root.find("name").value_or(root), e.name);
    e.folder = folder;
    e.film = p.film.json();
    for (const char* key : {"film", "scenes", "sweep", "scene", "until", "tune"})
        if (const auto node = root.find(key); node && node->isNull()) node->expected("a value");
    if (!p.film.isNull()) checkFilm(p.film);
    e.maxDepth = p.maxDepth;
    e.replicates = p.replicates;
    e.seed = p.seed;
    e.snapshots = p.snapshots;
    e.commonRandomNumbers = p.commonRandomNumbers;
    if (!p.until.isNull()) e.until = parseUntil(p.until, e.replicates);
    e.metrics = parseMetrics(p.metrics);

    if (p.scene.isNull() == p.scenes.isNull()) root.fail("expected either \"scene\" or \"scenes\"");
    if (!p.scene.isNull()) {
        e.scenes.push_back({"scene", p.scene, {}});
    } else {
        for (const auto& [name, node] : p.scenes.members()) {
            checkName(node, name);
            e.scenes.push_back({name, node, {}});
        }
        if (e.scenes.empty()) p.scenes.expected("at least one scene");
    }

    root.at("samplers");
    for (const auto& [name, node] : p.samplers.members()) e.samplers.push_back(parseSampler(name, node, e.maxDepth));
    if (e.samplers.empty()) p.samplers.expected("at least one sampler");
    std::vector<std::string> names;
    for (const NamedSampler& sampler : e.samplers) names.push_back(sampler.name);
    e.baseline = p.baseline;
    if (!e.baseline.empty() && std::find(names.begin(), names.end(), e.baseline) == names.end())
        unknownName("sampler of this experiment", e.baseline, names, root.at("baseline").where());

    root.at("budget");
    e.budget = parseBudget(p.budget);
    for (const NamedSampler& sampler : e.samplers)
        if (e.budget.mutations && !sampler.chains)
            p.budget.at("mutations")
                .fail(fmt::format("the sampler \"{}\" has no chains and so no mutations", sampler.name),
                      "give time, spp or rays");

    root.at("reference");
    for (NamedScene& scene : e.scenes) scene.reference = ReferenceReader(e).forScene(p.reference, scene.name);
    return e;
}

}  // namespace ulam
