#include "core/scene/loading/emitters.h"

#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/sunsky.h"
#include "core/scene/loading/transform.h"
#include "core/scene/octahedral_map.h"

namespace ulam {
namespace {

/// PointEmitter with what only the loader needs.
struct PointParameters : PointEmitter::Parameters {
    JsonNode position, toWorld;
    template <class V>
    void describe(V& v) {
        PointEmitter::Parameters::describe(v);
        v("position", position, {.help = "place [x,y,z]; instead of to_world", .example = "[0, 2, 0]"});
        v("to_world", toWorld,
          {.help = "moves the origin to the light's place",
           .example = R"([{"type": "translate", "value": [0, 1, 0]}])"});
    }
};

struct SpotParameters : SpotEmitter::Parameters {
    JsonNode toWorld;
    template <class V>
    void describe(V& v) {
        SpotEmitter::Parameters::describe(v);
        v("to_world", toWorld,
          {.help = "moves the light from the origin, where it shines along +z",
           .example = R"([{"type": "lookat", "origin": [0, 1, 4], "target": [0, 1, 0], "up": [0, 1, 0]}])"});
    }
};

struct DirectionalParameters : DirectionalEmitter::Parameters {
    JsonNode direction, toWorld;
    template <class V>
    void describe(V& v) {
        DirectionalEmitter::Parameters::describe(v);
        v("direction", direction,
          {.help = "in which the light travels [x,y,z]; instead of to_world", .example = "[0, -1, 0]"});
        v("to_world", toWorld,
          {.help = "turns the light, which travels along +z",
           .example = R"([{"type": "rotate", "axis": [1, 0, 0], "angle": 90}])"});
    }
};

struct EnvmapParameters : EnvmapEmitter::Parameters {
    JsonNode filename, toWorld;
    std::string mapping = "latlong";
    template <class V>
    void describe(V& v) {
        v("filename", filename,
          {.help = "picture of all directions, relative to the scene's folder and inside it",
           .example = R"("textures/sky.exr")"});
        v("mapping", mapping, {.help = "latitude and longitude, or the square of an octahedron with equal areas, its middle at +z (pbrt-v4)", .choices = {"latlong", "octahedral"}});
        EnvmapEmitter::Parameters::describe(v);
        v("to_world", toWorld,
          {.help = "turns the picture; its zenith is +y",
           .example = R"([{"type": "rotate", "axis": [0, 1, 0], "angle": 90}])"});
    }
};

Emitter readArea(const JsonNode& node, LoadContext&) {
    node.fail("an area emitter must be nested in a shape");
}

Vec3f turned(const Matrix4& m, const Vec3d& direction) {
    Vec3d out;
    m.multDirMatrix(direction, out);
    return Vec3f(out.normalized());
}

Emitter readSpot(const JsonNode& node, LoadContext&) {
    const auto p = parsePlugin<SpotParameters>(node);
    if (p.beamWidth > p.cutoffAngle)
        node.at("beam_width").fail(fmt::format("beam_width {:g} is wider than cutoff_angle {:g}", p.beamWidth, p.cutoffAngle));
    const Matrix4 m = parseTransform(p.toWorld);
    Vec3d place(0.0);
    m.multVecMatrix(Vec3d(0.0), place);
    return SpotEmitter(p, Vec3f(place), turned(m, {0, 0, 1}));
}

Emitter readDirectional(const JsonNode& node, LoadContext&) {
    const auto p = parsePlugin<DirectionalParameters>(node);
    if (!p.direction.isNull() && !p.toWorld.isNull()) p.toWorld.fail("a directional emitter has either a direction or a to_world");
    if (p.direction.isNull()) return DirectionalEmitter(p, turned(parseTransform(p.toWorld), {0, 0, 1}));
    const Vec3d direction = parseVector(p.direction);
    if (!(direction.length() > 0)) p.direction.expected("a direction longer than 0");
    return DirectionalEmitter(p, Vec3f(direction.normalized()));
}

Emitter readEnvmap(const JsonNode& node, LoadContext& context) {
    const auto p = parsePlugin<EnvmapParameters>(node);
    const Matrix4 m = parseTransform(p.toWorld);
    if (!uniformScale(m)) p.toWorld.fail("an envmap's to_world must keep angles: rotations and mirrorings only");
    const JsonNode filename = node.at("filename");
    Image image = context.readImage(filename, false);
    if (p.mapping == "octahedral") {
        if (image.width != image.height) filename.fail(fmt::format("an octahedral environment map is square, not {} x {} pixels", image.width, image.height));
        image = latLongFromOctahedral(image);
    }
    if (image.width < 2 || image.height < 3)
        filename.fail(fmt::format("the environment map has {} x {} pixels, it needs at least 2 x 3", image.width, image.height));
    for (const Rgb& pixel : image.pixels)
        if (pixel.x < 0 || pixel.y < 0 || pixel.z < 0) filename.fail("the environment map holds negative radiance");
    auto map = std::make_shared<const EnvironmentMap>(std::move(image), p.scale, axesOf(m));
    if (!(map->totalLuminance() > 0)) filename.fail("the environment map holds no light: it is black everywhere, or its scale is 0");
    return EnvmapEmitter{std::move(map)};
}

Emitter readPoint(const JsonNode& node, LoadContext&) {
    const auto p = parsePlugin<PointParameters>(node);
    if (!p.position.isNull() && !p.toWorld.isNull())
        p.toWorld.fail("a point emitter has either a position or a to_world");
    Vec3d place(0.0);
    parseTransform(p.toWorld).multVecMatrix(Vec3d(0.0), place);
    if (!p.position.isNull()) place = parseVector(p.position);
    return PointEmitter(p, Vec3f(place));
}

Emitter readConstant(const JsonNode& node, LoadContext&) {
    return ConstantEmitter{parsePlugin<ConstantEmitter::Parameters>(node).radiance};
}

const PluginTable<Emitter(const JsonNode&, LoadContext&)>& emitterTable() {
    static const PluginTable<Emitter(const JsonNode&, LoadContext&)> plugins(
        "emitter", {
                       {{"area", "the surface of the shape that it is nested in, on the side of its normals",
                         parameterInfo<AreaEmitter::Parameters>(), {"radiance"}},
                        readArea},
                       {{"constant", "the same radiance from everywhere", parameterInfo<ConstantEmitter::Parameters>()},
                        readConstant},
                       {{"directional", "parallel light from infinity", parameterInfo<DirectionalParameters>()}, readDirectional},
                       {{"envmap", "radiance from all around, from a picture", parameterInfo<EnvmapParameters>()}, readEnvmap},
                       {{"point", "the same intensity in all directions", parameterInfo<PointParameters>()}, readPoint},
                       {{"spot", "a point that shines into a cone", parameterInfo<SpotParameters>()}, readSpot},
                       {{"sunsky", "a clear sky and the sun (Hosek and Wilkie)", sunskyParameters()}, readSunsky},
                   });
    return plugins;
}

}  // namespace

std::vector<PluginInfo> emitterPlugins() {
    return emitterTable().infos();
}

Emitter readAreaEmitter(const JsonNode& node, uint32_t shape, PluginResolver& resolver) {
    if (emitterTable().find(node).read != &readArea)
        node.fail(fmt::format("{} cannot be nested in a shape; area can", inQuotes(pluginName(node))));
    const auto textured = texturedParameters(node, emitterTable().find(node).info, resolver);
    if (textured.empty()) return AreaEmitter{parsePlugin<AreaEmitter::Parameters>(node).radiance, shape};
    return AreaEmitter{parseOtherParameters<AreaEmitter::Parameters>(node, {"radiance"}).radiance, shape, textured.front().texture};
}

Emitter readEmitter(const JsonNode& node, LoadContext& context) {
    return emitterTable().find(node).read(node, context);
}

}  // namespace ulam
