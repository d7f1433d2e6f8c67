#pragma once
// Textures in the place of parameters, and references to entries of the scene.

#include "core/scene/loading/plugin_table.h"

namespace ulam {

/// What readers of plugins ask the scene's loader for.
class PluginResolver {
public:
    /// The entry that a {"type": "ref"} names; other plugins as they are.
    virtual JsonNode resolve(const JsonNode& node) = 0;
    /// Is it a texture, or a reference to one?
    virtual bool isTexture(const JsonNode& node) const = 0;
    /// Index into Scene::textures of a texture that stands in the place of a parameter.
    virtual uint32_t texture(const JsonNode& node, const ParameterInfo& parameter) = 0;

protected:
    ~PluginResolver() = default;
};

/// A parameter that a texture takes the place of.
struct TexturedParameter {
    std::string name;
    uint32_t texture;
};

/// The parameters of a plugin in whose place a texture stands; fails where one is not among info.textured.
std::vector<TexturedParameter> texturedParameters(const JsonNode& node, const PluginInfo& info, PluginResolver& resolver);

/// parsePlugin of the parameters but for those in `elsewhere`.
template <Described P>
P parseOtherParameters(const JsonNode& node, const std::vector<std::string>& elsewhere) {
    std::vector<std::string> keys = structuralKeys(node, parameterInfo<P>());
    keys.insert(keys.end(), elsewhere.begin(), elsewhere.end());
    return parseParameters<P>(node, keys);
}

}  // namespace ulam
