#include "core/scene/plugins.h"

#include "core/scene/generator.h"
#include "core/scene/loading/emitters.h"
#include "core/scene/loading/materials.h"
#include "core/scene/loading/sensors.h"
#include "core/scene/loading/shapes.h"
#include "core/scene/loading/textures.h"

namespace ulam {
namespace {

Json identifier() {
    return {{"type", "string"}, {"description", "name that a ref may refer to"}, {"examples", Json::array({"white"})}};
}

std::vector<PluginInfo> generators() {
    std::vector<PluginInfo> result;
    for (const auto* entry : Registry<Generator>::instance().entries())
        result.push_back({entry->name, entry->summary, entry->parameters, {}});
    return result;
}

/// One plugin's dictionary; `open` lets others be nested in it.
Json pluginSchema(const PluginInfo& plugin, bool open) {
    Json schema = jsonSchema(plugin.parameters);
    schema["description"] = plugin.summary;
    for (const std::string& name : plugin.textured) {
        Json& plain = schema["properties"][name];
        plain = {{"anyOf", Json::array({plain, {{"$ref", "#/definitions/plugin"}}})},
                 {"description", plain["description"]},
                 {"examples", plain["examples"]}};
    }
    schema["properties"]["type"] = {{"const", plugin.name}};
    schema["properties"]["id"] = identifier();
    schema["required"] = Json::array({"type"});
    if (open) schema["additionalProperties"] = {{"$ref", "#/definitions/plugin"}};
    return schema;
}

}  // namespace

std::vector<PluginInfo> scenePlugins(PluginKind kind) {
    switch (kind) {
        case PluginKind::Shapes:
            return shapePlugins();
        case PluginKind::Bsdfs:
            return bsdfPlugins();
        case PluginKind::Emitters:
            return emitterPlugins();
        case PluginKind::Sensors:
            return sensorPlugins();
        case PluginKind::Textures:
            return texturePlugins();
        case PluginKind::Films:
            return filmPlugins();
        case PluginKind::Filters:
            return filterPlugins();
        case PluginKind::Generators:
            return generators();
    }
    return {};
}

Json sceneSchema() {
    Json plugins = Json::array();
    for (const PluginKind kind :
         {PluginKind::Shapes, PluginKind::Bsdfs, PluginKind::Emitters, PluginKind::Sensors, PluginKind::Textures, PluginKind::Films})
        for (const PluginInfo& plugin : scenePlugins(kind)) plugins.push_back(pluginSchema(plugin, true));
    plugins.push_back({{"type", "object"},
                       {"properties", {{"type", {{"const", "ref"}}}, {"id", identifier()}}},
                       {"required", Json::array({"type", "id"})},
                       {"additionalProperties", false}});
    const Json scene = {{"type", "object"},
                        {"description", "a dictionary of shapes, BSDFs, emitters and one sensor"},
                        {"properties",
                         {{"type", {{"const", "scene"}}},
                          {"id", identifier()},
                          {"$schema",
                           {{"type", "string"},
                            {"description", "JSON Schema for editors; not read"},
                            {"examples", Json::array({"scene.schema.json"})}}},
                          {"integrator",
                           {{"type", "object"},
                            {"description", "of Mitsuba's own; not read"},
                            {"examples", Json::array({Json{{"type", "path"}}})}}},
                          {"sampler",
                           {{"type", "object"},
                            {"description", "of Mitsuba's own; not read"},
                            {"examples", Json::array({Json{{"type", "independent"}}})}}}}},
                        {"required", Json::array({"type"})},
                        {"additionalProperties", {{"$ref", "#/definitions/plugin"}}}};
    Json alternatives = Json::array({scene});
    for (const PluginInfo& generator : generators()) alternatives.push_back(pluginSchema(generator, false));
    return {{"$schema", "http://json-schema.org/draft-07/schema#"},
            {"title", "Ulam scene"},
            {"definitions", {{"plugin", {{"anyOf", plugins}}}}},
            {"anyOf", alternatives}};
}

}  // namespace ulam
