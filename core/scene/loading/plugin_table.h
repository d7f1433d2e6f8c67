#pragma once
// Plugins of one kind: name, help, parameters, and the function that reads one from its dictionary.

#include <fmt/format.h>

#include "core/config/json.h"
#include "core/config/suggest.h"
#include "core/scene/plugins.h"

namespace ulam {

/// One value of a dictionary that is a plugin itself: {"type": …} under a name of the user's choice.
bool isPlugin(const JsonNode& node);
/// The name in "type".
const std::string& pluginName(const JsonNode& node);
/// Does a table hold this name?
bool contains(const std::vector<PluginInfo>& plugins, const std::string& name);
/// Fails with the names of these plugins and the nearest one.
[[noreturn]] void unknownPlugin(const JsonNode& node, std::string_view kind, const std::vector<PluginInfo>& plugins);

/// The names of members that are no parameters but plugins (a shape's BSDF, a sensor's film), and "type" and "id".
std::vector<std::string> structuralKeys(const JsonNode& node, const std::vector<ParameterInfo>& parameters);
/// The plugins among a dictionary's members.
std::vector<JsonNode> nestedPlugins(const JsonNode& node, const std::vector<ParameterInfo>& parameters);

/// parseParameters for a plugin that may hold others. A texture where only a colour is supported fails with its name.
template <Described P>
P parsePlugin(const JsonNode& node);

void refuseTextures(const JsonNode& node, const std::vector<ParameterInfo>& parameters);

template <Described P>
P parsePlugin(const JsonNode& node) {
    const std::vector<ParameterInfo> parameters = parameterInfo<P>();
    refuseTextures(node, parameters);
    return parseParameters<P>(node, structuralKeys(node, parameters));
}

template <class Function>
class PluginTable {
public:
    struct Entry {
        PluginInfo info;
        Function* read;
    };

    PluginTable(std::string kind, std::vector<Entry> entries) : kind_(std::move(kind)), entries_(std::move(entries)) {}

    const Entry& find(const JsonNode& node) const {
        for (const Entry& entry : entries_)
            if (entry.info.name == pluginName(node)) return entry;
        unknownPlugin(node, kind_, infos());
    }

    std::vector<PluginInfo> infos() const {
        std::vector<PluginInfo> result;
        for (const Entry& entry : entries_) result.push_back(entry.info);
        return result;
    }

private:
    std::string kind_;
    std::vector<Entry> entries_;
};

}  // namespace ulam
