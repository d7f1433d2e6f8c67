// The JSON Schema of an experiment, from the descriptions that the parser uses.

#include "core/image/metrics.h"
#include "core/scene/plugins.h"
#include "experiments/engine/experiment.h"

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

}  // namespace

Json experimentSchema() {
    const Json text = {{"type", "string"}}, number = {{"type", "number"}};

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

    Json metricNames = Json::array();
    for (const Metric& metric : metrics()) metricNames.push_back(metric.name);
    const Json range = {{"type", "object"},
                        {"properties",
                         {{"log", {{"type", "array"}, {"items", number}, {"minItems", 2}, {"maxItems", 2}}},
                          {"steps", {{"type", "integer"}, {"minimum", 2}}}}},
                        {"required", {"log", "steps"}},
                        {"additionalProperties", false}};
    const Json values = anyOf({{{"type", "array"}, {"minItems", 1}}, range});

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
           {{"type", "object"}, {"properties", {{"zip", membersLike(values)}}}, {"additionalProperties", values}});
    schema["required"] = Json::array({"samplers", "budget", "reference"});
    schema["definitions"] = definitions;
    return schema;
}

}  // namespace ulam
