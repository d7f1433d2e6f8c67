#include "core/scene/loading/plugin_table.h"

#include <algorithm>

namespace ulam {

bool isPlugin(const JsonNode& node) {
    return node.isObject() && node.json().contains("type");
}

const std::string& pluginName(const JsonNode& node) {
    return node.at("type").string();
}

bool contains(const std::vector<PluginInfo>& plugins, const std::string& name) {
    return std::any_of(plugins.begin(), plugins.end(), [&](const PluginInfo& p) { return p.name == name; });
}

void unknownPlugin(const JsonNode& node, std::string_view kind, const std::vector<PluginInfo>& plugins) {
    std::vector<std::string> names;
    for (const PluginInfo& plugin : plugins) names.push_back(plugin.name);
    unknownName(kind, pluginName(node), names, node.at("type").where());
}

std::vector<JsonNode> nestedPlugins(const JsonNode& node, const std::vector<ParameterInfo>& parameters) {
    std::vector<JsonNode> result;
    for (const auto& [key, member] : node.members()) {
        const auto hasName = [name = key](const ParameterInfo& p) { return p.name == name; };
        if (std::none_of(parameters.begin(), parameters.end(), hasName) && isPlugin(member)) result.push_back(member);
    }
    return result;
}

std::vector<std::string> structuralKeys(const JsonNode& node, const std::vector<ParameterInfo>& parameters) {
    std::vector<std::string> keys = {"type", "id"};
    for (const JsonNode& plugin : nestedPlugins(node, parameters)) keys.push_back(plugin.key());
    return keys;
}

void refuseTextures(const JsonNode& node, const std::vector<ParameterInfo>& parameters) {
    for (const ParameterInfo& parameter : parameters) {
        const auto value = node.find(parameter.name);
        if (parameter.type == "spectrum" && value && isPlugin(*value) && pluginName(*value) != "rgb")
            unknownPlugin(*value, "texture", scenePlugins(PluginKind::Textures));
    }
}

}  // namespace ulam
