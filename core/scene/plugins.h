#pragma once
// What may stand in a scene dictionary. The loader takes names and parameters from the same tables.

#include <string>
#include <vector>

#include "core/config/parameters.h"

namespace ulam {

enum class PluginKind { Shapes, Bsdfs, Emitters, Sensors, Textures, Films, Filters, Generators };

struct PluginInfo {
    std::string name;
    std::string summary;
    std::vector<ParameterInfo> parameters;
    std::vector<std::string> textured = {};  ///< parameters in whose place a texture may stand
};

/// The plugins of a kind; generators are those registered in the program.
std::vector<PluginInfo> scenePlugins(PluginKind kind);

/// JSON Schema (draft 7) of a scene: a dictionary of plugins, or a generator.
Json sceneSchema();

}  // namespace ulam
