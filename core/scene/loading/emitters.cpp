#include "core/scene/loading/emitters.h"

#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"

namespace ulam {
namespace {

/// PointEmitter with what only the loader needs.
struct PointParameters : PointEmitter::Parameters {
    JsonNode position, toWorld;
    template <class V>
    void describe(V& v) {
        PointEmitter::Parameters::describe(v);
        v("position", position, {.help = "place [x,y,z]; instead of to_world"});
        v("to_world", toWorld, {.help = "moves the origin to the light's place"});
    }
};

Emitter readArea(const JsonNode& node) {
    node.fail("an area emitter must be nested in a shape");
}

Emitter readPoint(const JsonNode& node) {
    const auto p = parsePlugin<PointParameters>(node);
    if (!p.position.isNull() && !p.toWorld.isNull())
        p.toWorld.fail("a point emitter has either a position or a to_world");
    Vec3d place(0.0);
    parseTransform(p.toWorld).multVecMatrix(Vec3d(0.0), place);
    if (!p.position.isNull()) place = parseVector(p.position);
    return PointEmitter{p.intensity, Vec3f(place)};
}

Emitter readConstant(const JsonNode& node) {
    return ConstantEmitter{parsePlugin<ConstantEmitter::Parameters>(node).radiance};
}

const PluginTable<Emitter(const JsonNode&)>& table() {
    static const PluginTable<Emitter(const JsonNode&)> plugins(
        "emitter", {
                       {{"area", "the surface of the shape that it is nested in, on the side of its normals",
                         parameterInfo<AreaEmitter::Parameters>()},
                        readArea},
                       {{"constant", "the same radiance from everywhere", parameterInfo<ConstantEmitter::Parameters>()},
                        readConstant},
                       {{"point", "the same intensity in all directions", parameterInfo<PointParameters>()}, readPoint},
                   });
    return plugins;
}

}  // namespace

std::vector<PluginInfo> emitterPlugins() {
    return table().infos();
}

Emitter readAreaEmitter(const JsonNode& node, uint32_t shape) {
    if (table().find(node).read != &readArea)
        node.fail(fmt::format("{} cannot be nested in a shape; area can", inQuotes(pluginName(node))));
    return AreaEmitter{parsePlugin<AreaEmitter::Parameters>(node).radiance, shape};
}

Emitter readEmitter(const JsonNode& node) {
    return table().find(node).read(node);
}

}  // namespace ulam
