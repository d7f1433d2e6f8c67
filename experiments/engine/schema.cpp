// The JSON Schema of an experiment, from the descriptions that the parser uses.

#include "core/base/error.h"
#include "core/image/metrics.h"
#include "core/mcmc/target.h"
#include "core/scene/loading/sensors.h"
#include "core/scene/plugins.h"
#include "experiments/engine/experiment.h"
#include "experiments/engine/sweep_values.h"

namespace ulam {
namespace {

/// `schema` in place of the free form of a property, whose description and example stay.
void refine(Json& object, const char* property, Json schema) {
    Json& place = object["properties"][property];
    for (const char* kept : {"description", "examples"})
        if (place.contains(kept)) schema[kept] = place[kept];
    place = std::move(schema);
}

Json reference(const char* definition) {
    return {{"$ref", std::string("#/definitions/") + definition}};
}

Json anyOf(const std::vector<Json>& alternatives) {
    return {{"anyOf", alternatives}};
}

Json membersLike(const Json& schema) {
    return {{"type", "object"}, {"additionalProperties", schema}, {"minProperties", 1}};
}

/// The same, where names become parts of folders' names.
Json namedLike(const Json& schema) {
    Json members = membersLike(schema);
    members["propertyNames"] = {{"pattern", "^[A-Za-z0-9_+-]{1,64}$"}};
    return members;
}

/// A registered plugin with its parameters, and with its "type".
template <class Entry>
Json pluginSchema(const Entry& entry) {
    Json schema = jsonSchema(entry.parameters);
    schema["description"] = entry.summary;
    schema["properties"]["type"] = {{"const", entry.name}};
    schema["required"] = Json::array({"type"});
    return schema;
}

bool accepts(const std::string& sampler, const std::string& mutation) {
    try {
        Registry<Sampler>::instance().create(JsonNode(Json{{"type", sampler}, {"mutations", {{mutation, Json::object()}}}}));
        return true;
    } catch (const Error&) {
        return false;
    }
}

/// Mutations by name: that of a registered one, or any with a "type".
Json mixSchema(const std::string& sampler) {
    Json typed = Json::array(), own = Json::object();
    for (const auto* entry : Registry<Mutation>::instance().entries()) {
        if (!accepts(sampler, entry->name)) continue;
        Json schema = pluginSchema(*entry);
        schema["properties"]["weight"] = {{"type", "number"},
                                          {"minimum", 0},
                                          {"maximum", 1e9},
                                          {"default", 1},
                                          {"examples", Json::array({1})},
                                          {"description", "relative probability of being chosen"}};
        typed.push_back(schema);
        schema.erase("required");
        own[entry->name] = schema;
    }
    for (auto& schema : own) {
        const Json summary = schema["description"];
        schema = anyOf({schema, {{"anyOf", typed}}});
        schema["description"] = summary;
        schema["examples"] = Json::array({Json{{"weight", 1}}});
    }
    Json mix = membersLike({{"anyOf", typed}});
    mix["properties"] = own;
    return mix;
}

/// A sampler of an experiment, which gives all of them one depth.
Json samplerSchema(const Registry<Sampler>::Entry& entry) {
    Json schema = pluginSchema(entry);
    Json& properties = schema["properties"];
    properties.erase("max_depth");
    if (properties.contains("target")) refine(schema, "target", {{"enum", Registry<Importance>::instance().names()}, {"default", properties["target"]["default"]}});
    if (properties.contains("mutations")) refine(schema, "mutations", mixSchema(entry.name));
    return schema;
}

/// What stands for a part of the film of every scene.
Json filmSchema() {
    Json schema = pluginSchema(scenePlugins(PluginKind::Films).front());
    schema.erase("required");
    std::vector<Json> filters;
    for (const PluginInfo& filter : scenePlugins(PluginKind::Filters)) filters.push_back(pluginSchema(filter));
    filters.push_back({{"type", "object"}, {"properties", {{"type", {{"enum", replacedFilters()}}}}}, {"required", Json::array({"type"})}});
    refine(schema, "rfilter", anyOf(filters));
    return schema;
}

/// The longest path of any sampler.
double largestDepth() {
    double largest = 1;
    for (const auto* entry : Registry<Sampler>::instance().entries())
        for (const ParameterInfo& p : entry->parameters)
            if (p.name == "max_depth") largest = std::max(largest, p.max.value_or(largest));
    return largest;
}

/// "truth", a file, an image with its variance, or a sampler with its budget.
Json referenceSchema() {
    const Json all = jsonSchema(parameterInfo<ReferenceParameters>());
    const auto with = [&](const std::vector<std::string>& keys, std::vector<std::string> required) {
        Json schema = {{"type", "object"}, {"properties", Json::object()}, {"required", required}, {"additionalProperties", false}};
        for (const std::string& key : keys) schema["properties"][key] = all["properties"][key];
        return schema;
    };
    Json image = with({"image", "variance"}, {"image"}),
         made = with({"sampler", "budget", "part"}, {"sampler", "budget"});
    image["properties"]["image"]["pattern"] = "\\.exr$";
    refine(made, "sampler", anyOf({{{"type", "string"}, {"minLength", 1}}, reference("sampler")}));
    refine(made, "budget", reference("budget"));
    refine(made, "part", reference("budget"));
    return anyOf({{{"type", "string"}, {"pattern", "^truth$|\\.exr$"}}, image, made});
}

/// A list, or a range with equal steps or random draws (sweep_values.h).
Json sweepValuesSchema() {
    std::vector<Json> forms{{{"type", "array"}, {"minItems", 1}, {"description", "each of these values"}}};
    for (const bool logarithmic : {false, true})
        for (const bool drawn : {false, true}) {
            const char *scale = logarithmic ? "log" : "linear", *number = drawn ? "draws" : "steps";
            Json end = {{"type", "number"}}, ends = Json::array({1, 1000});
            if (logarithmic) end["exclusiveMinimum"] = 0;
            forms.push_back(
                {{"type", "object"},
                 {"properties",
                  {{scale,
                    {{"type", "array"},
                     {"items", end},
                     {"minItems", 2},
                     {"maxItems", 2},
                     {"description", "first and last value"},
                     {"examples", Json::array({ends})}}},
                   {number,
                    {{"type", "integer"},
                     {"minimum", drawn ? 1 : 2},
                     {"maximum", kMostSweepValues},
                     {"description", drawn ? "how many random values" : "how many values, the ends included"},
                     {"examples", Json::array({4})}}}}},
                 {"required", {scale, number}},
                 {"additionalProperties", false}});
        }
    return {{"anyOf", forms}};
}

/// Of the points that are run (sweep_filter.h).
Json conditions() {
    const Json text = {{"type", "string"}}, single = {{"type", {"number", "string", "boolean"}}};
    const Json path = {{"type", "object"},
                       {"properties",
                        {{"path",
                          {{"type", "string"},
                           {"description", "whose value at the point is compared with"},
                           {"examples", Json::array({"samplers.mlt.chains"})}}}}},
                       {"required", Json::array({"path"})},
                       {"additionalProperties", false}};
    const auto condition = [&](Json comparison, Json value) -> Json {
        return {{"type", "array"}, {"items", Json::array({text, std::move(comparison), std::move(value)})}, {"minItems", 3}, {"maxItems", 3}};
    };
    const Json order = {{"enum", {"<", "<=", ">", ">=", "==", "!="}}}, among = {{"const", "in"}};
    return {{"type", "array"},
            {"description", "conditions [path, comparison, value] that a point must meet to be run"},
            {"examples", Json::array({Json::array({Json::array({"max_depth", ">", 2})})})},
            {"items", anyOf({condition(order, anyOf({single, path})),
                             condition(among, {{"type", "array"}, {"items", single}, {"minItems", 1}})})}};
}

}  // namespace

Json experimentSchema() {
    Json samplers = Json::array();
    for (const auto* entry : Registry<Sampler>::instance().entries()) samplers.push_back(samplerSchema(*entry));

    // A scene's schema refers to its own definitions: they move into this document under their names.
    Json scene = sceneSchema();
    Json definitions = scene["definitions"];
    scene.erase("definitions");
    scene.erase("$schema");
    definitions["scene"] = anyOf({{{"type", "string"}, {"minLength", 1}, {"description", "a file, relative to the experiment"}}, scene});
    definitions["sampler"] = {{"anyOf", samplers}};
    definitions["budget"] = jsonSchema(parameterInfo<BudgetParameters>());
    definitions["budget"]["minProperties"] = 1;
    for (Json& limit : definitions["budget"]["properties"]) {
        limit.erase("minimum"), limit.erase("default");
        limit["exclusiveMinimum"] = 0;
    }
    definitions["reference"] = referenceSchema();

    definitions["sweepValues"] = sweepValuesSchema();

    Json metricNames = Json::array(), errorNames = Json::array();
    for (const Metric& metric : metrics()) {
        metricNames.push_back(metric.name);
        if (!metric.higherIsBetter) errorNames.push_back(metric.name);
    }

    Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Ulam experiment"}};
    schema.update(jsonSchema(parameterInfo<ExperimentParameters>()));
    refine(schema, "scene", reference("scene"));
    refine(schema, "scenes", namedLike(reference("scene")));
    schema["properties"]["name"]["pattern"] = "^[A-Za-z0-9_+-]{0,64}$";
    schema["properties"]["max_depth"]["maximum"] = largestDepth();
    refine(schema, "film", filmSchema());
    refine(schema, "samplers", namedLike(reference("sampler")));
    refine(schema, "budget", reference("budget"));
    refine(schema, "until", jsonSchema(parameterInfo<UntilParameters>()));
    refine(schema, "metrics",
           {{"type", "array"},
            {"items", Json::array({{{"enum", errorNames}}})},  // of the first
            {"additionalItems", {{"enum", metricNames}}},
            {"minItems", 1},
            {"uniqueItems", true}});
    Json byScene = namedLike(reference("reference"));
    byScene["not"] = anyOf({{{"required", Json::array({"sampler"})}}, {{"required", Json::array({"budget"})}}, {{"required", Json::array({"image"})}}});
    refine(schema, "reference", anyOf({reference("reference"), byScene}));
    Json zip = membersLike(reference("sweepValues"));
    zip["description"] = "paths whose values go together, the first with the first: no grid";
    zip["examples"] = Json::array({Json{{"max_depth", {2, 4, 8}}, {"budget.time", {1, 2, 4}}}});
    definitions["sweep"] = {{"type", "object"},
                            {"properties", {{"zip", zip}, {"where", conditions()}}},
                            {"additionalProperties", reference("sweepValues")}};
    refine(schema, "sweep", reference("sweep"));
    Json tune = jsonSchema(parameterInfo<TuneParameters>());
    refine(tune, "sweep", reference("sweep"));
    tune["required"] = Json::array({"sweep"});
    refine(schema, "tune", tune);
    const Json file = {{"type", "string"}, {"pattern", "^[^/]+$"}};
    refine(schema, "extends", anyOf({file, {{"type", "array"}, {"items", file}}}));
    // What a file leaves out the ones that it extends may have.
    Json complete = {{"required", Json::array({"samplers", "budget", "reference"})}};
    complete["oneOf"] = Json::array({{{"required", Json::array({"scene"})}}, {{"required", Json::array({"scenes"})}}});
    schema["anyOf"] = Json::array({{{"required", Json::array({"extends"})}}, complete});
    schema["definitions"] = definitions;
    return schema;
}

}  // namespace ulam
