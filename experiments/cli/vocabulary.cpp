#include "experiments/cli/vocabulary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/scene/plugins.h"

namespace ulam {
namespace {

struct Chapter {
    const char* title;
    PluginKind kind;
    /// Names that Mitsuba 0.6 or 3 has too.
    std::vector<const char*> inMitsuba;
};

const std::vector<Chapter>& chapters() {
    static const std::vector<Chapter> all{
        {"Shapes",
         PluginKind::Shapes,
         {"bsplinecurve", "ellipsoids", "ellipsoidsmesh", "hair", "heightfield", "instance", "linearcurve", "sdfgrid",
          "shapegroup"}},
        {"BSDFs",
         PluginKind::Bsdfs,
         {"circular", "difftrans", "hair", "hk", "irawan", "measured", "measured_polarized", "polarizer", "pplastic",
          "principledthin", "retarder"}},
        {"Emitters",
         PluginKind::Emitters,
         {"collimated", "directionalarea", "projector", "timed_sunsky"}},
        {"Textures",
         PluginKind::Textures,
         {"curvature", "gridtexture", "mesh_attribute", "scale", "vertexcolors", "volume", "wireframe"}},
        {"Sensors",
         PluginKind::Sensors,
         {"batch", "distant", "fluencemeter", "irradiancemeter", "orthographic", "perspective_rdist", "radiancemeter",
          "spherical", "telecentric"}},
        {"Films", PluginKind::Films, {"ldrfilm", "mfilm", "specfilm", "tiledhdrfilm"}},
        {"Reconstruction filters", PluginKind::Filters, {"catmullrom", "lanczos", "mitchell"}},
    };
    return all;
}

/// A cell of a table in Markdown.
std::string cell(std::string text) {
    for (size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.replace(i, 1, "\\|");
    return text;
}

std::string kindOf(const ParameterInfo& p) {
    if (!p.unit.empty()) return p.unit;
    return p.type == "json" ? "" : p.type;
}

}  // namespace

std::string sceneVocabulary() {
    std::string text;
    for (const Chapter& chapter : chapters()) {
        text += fmt::format(
            "## {}\n\n| plugin | parameter | unit or type | default | values | meaning |\n| --- | --- | --- | --- | "
            "--- | --- |\n",
            chapter.title);
        const std::vector<PluginInfo> plugins = scenePlugins(chapter.kind);
        for (const PluginInfo& plugin : plugins) {
            text += fmt::format("| `{}` | | | | | {} |\n", plugin.name, cell(plugin.summary));
            for (const ParameterInfo& p : plugin.parameters) {
                const bool textured = std::ranges::find(plugin.textured, p.name) != plugin.textured.end();
                text += fmt::format("| | `{}` | {} | {} | {} | {} |\n", p.name,
                                    kindOf(p) + (textured ? ", or texture" : ""),
                                    p.defaultValue.is_null() ? "" : fmt::format("`{}`", cell(p.defaultValue.dump())),
                                    cell(p.range()), cell(p.help));
            }
        }
        std::vector<std::string> missing;
        for (const char* name : chapter.inMitsuba)
            if (std::ranges::none_of(plugins, [name](const PluginInfo& p) { return p.name == name; }))
                missing.push_back(fmt::format("`{}`", name));
        if (!missing.empty())
            text += fmt::format("\nNot supported, though Mitsuba has them: {}.\n", fmt::join(missing, ", "));
        text += "\n";
    }
    return text + "Participating media, phase functions and subsurface scattering are not supported.\n";
}

}  // namespace ulam
