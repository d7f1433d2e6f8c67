// The JSON Schema of an experiment, from the descriptions that the parser uses.

#include "core/image/metrics.h"
#include "core/scene/plugins.h"
#include "experiments/engine/experiment.h"
#include "experiments/engine/sweep_values.h"

namespace ulam {
namespace {

Json registeredSampler(const Registry<Sampler>::Entry& entry) {
    Json schema = jsonSchema(entry.parameters);
    schema["description"] = entry.summary;
    schema["properties"]["type"] = {{"const", entry.name}};
    schema["required"] = Json::array({"type"});
    return schema;
}

/// `schema` in place of the free form of a property, whose description stays.
void refine(Json& object, const char* property, Json schema) {
    Json& place = object["properties"][property];
    if (place.contains("description")) schema["description"] = place["description"];
    place = std::move(schema);
}

Json anyOf(std::initializer_list<Json> alternatives) {
    return {{"anyOf", Json(std::vector<Json>(alternatives))}};
}

Json membersLike(const Json& schema) {
    return {{"type", "object"}, {"additionalProperties", schema}, {"minProperties", 1}};
}

Json reference(const char* definition) {
    return {{"$ref", std::string("#/definitions/") + definition}};
}

/// A list, or a range with equal steps or random draws (sweep_values.h).
Json sweepValuesSchema() {
    std::vector<Json> forms{{{"type", "array"}, {"minItems", 1}, {"description", "each of these values"}}};
    for (const bool logarithmic : {false, true})
        for (const bool drawn : {false, true}) {
            const char *scale = logarithmic ? "log" : "linear", *number = drawn ? "draws" : "steps";
            Json end = {{"type", "number"}};
            if (logarithmic) end["exclusiveMinimum"] = 0;
            forms.push_back({{"type", "object"},
                             {"properties",
                              {{scale, {{"type", "array"}, {"items", end}, {"minItems", 2}, {"maxItems", 2}, {"description", "first and last value"}}},
                               {number, {{"type", "integer"}, {"minimum", drawn ? 1 : 2}, {"maximum", kMostSweepValues}, {"description", drawn ? "how many random values" : "how many values, the ends included"}}}}},
                             {"required", {scale, number}},
                             {"additionalProperties", false}});
        }
    return {{"anyOf", forms}};
}

/// Of the points that are run (sweep_filter.h).
Json conditions() {
    const Json text = {{"type", "string"}}, single = {{"type", {"number", "string", "boolean"}}};
    const Json path = {{"type", "object"}, {"properties", {{"path", text}}}, {"required", Json::array({"path"})}, {"additionalProperties", false}};
    const auto condition = [&](Json comparison, Json value) -> Json {
        return {{"type", "array"}, {"items", Json::array({text, std::move(comparison), std::move(value)})}, {"minItems", 3}, {"maxItems", 3}};
    };
    const Json order = {{"enum", {"<", "<=", ">", ">=", "==", "!="}}}, among = {{"const", "in"}};
    return {{"type", "array"},
            {"description", "conditions [path, comparison, value] that a point must meet to be run"},
            {"items", anyOf({condition(order, anyOf({single, path})), condition(among, {{"type", "array"}, {"items", single}, {"minItems", 1}})})}};
}

}  // namespace

Json experimentSchema() {
    const Json text = {{"type", "string"}};

    Json samplers = Json::array();
    Json samplerNames = Json::array();
    for (const auto* entry : Registry<Sampler>::instance().entries()) {
        samplers.push_back(registeredSampler(*entry));
        samplerNames.push_back(entry->name);
    }

    // A scene's schema refers to its own definitions: they move into this document under their names.
    Json scene = sceneSchema();
    Json definitions = scene["definitions"];
    scene.erase("definitions");
    scene.erase("$schema");
    definitions["scene"] = anyOf({text, scene});
    definitions["sampler"] = {{"anyOf", samplers}};
    definitions["budget"] = jsonSchema(parameterInfo<BudgetParameters>());
    definitions["budget"]["minProperties"] = 1;

    Json made = jsonSchema(parameterInfo<ReferenceParameters>());
    refine(made, "sampler", anyOf({text, reference("sampler")}));
    refine(made, "budget", reference("budget"));
    definitions["reference"] = anyOf({text, made});

    definitions["sweepValues"] = sweepValuesSchema();

    Json metricNames = Json::array();
    for (const Metric& metric : metrics()) metricNames.push_back(metric.name);

    Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Ulam experiment"}};
    schema.update(jsonSchema(parameterInfo<ExperimentParameters>()));
    refine(schema, "scene", reference("scene"));
    refine(schema, "scenes", membersLike(reference("scene")));
    refine(schema, "film", {{"type", "object"}});
    refine(schema, "samplers", membersLike(reference("sampler")));
    refine(schema, "budget", reference("budget"));
    refine(schema, "metrics",
           {{"type", "array"}, {"items", {{"enum", metricNames}}}, {"minItems", 1}, {"uniqueItems", true}});
    refine(schema, "reference", anyOf({reference("reference"), membersLike(reference("reference"))}));
    refine(schema, "sweep",
           {{"type", "object"},
            {"properties", {{"zip", membersLike(reference("sweepValues"))}, {"where", conditions()}}},
            {"additionalProperties", reference("sweepValues")}});
    schema["required"] = Json::array({"samplers", "budget", "reference"});
    schema["definitions"] = definitions;
    return schema;
}

}  // namespace ulam
