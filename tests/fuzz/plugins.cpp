// The readers ask which plugins the renderer has. The names that change what they do stand for the renderer here.

#include "core/scene/plugins.h"

namespace ulam {

std::vector<PluginInfo> scenePlugins(PluginKind kind) {
    switch (kind) {
        case PluginKind::Shapes:
            return {{"sphere", "", {}}, {"instance", "", {}}};
        case PluginKind::Bsdfs:
            return {{"diffuse", "", {}}, {"blendbsdf", "", {}}};
        case PluginKind::Emitters:
            return {{"area", "", {}}};
        case PluginKind::Textures:
            return {{"bitmap", "", {}}, {"checkerboard", "", {}}};
        default:
            return {};
    }
}

}  // namespace ulam
