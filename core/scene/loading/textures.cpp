#include "core/scene/loading/textures.h"

#include "core/image/image_io.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"

namespace ulam {
namespace {

struct RgbParameters {
    JsonNode value;
    template <class V>
    void describe(V& v) {
        v("value", value, {.help = "a number or [r,g,b], linear Rec. 709", .example = "[0.8, 0.4, 0.2]"});
    }
};

/// A texture with what only the loader needs.
template <class P>
struct Placed : P {
    JsonNode toUv;
    template <class V>
    void describe(V& v) {
        P::describe(v);
        v("to_uv", toUv,
          {.help = "surface parameters to texture coordinates: a matrix or a list of steps",
           .example = R"([{"type": "scale", "value": [4, 4, 1]}])"});
    }
};

struct BitmapParameters : Placed<BitmapTexture::Parameters> {
    JsonNode filename;
    Spectrum scale{1, 1, 1};
    bool invert = false;
    template <class V>
    void describe(V& v) {
        v("filename", filename,
          {.help = "exr, hdr, pfm, png, jpg or tga file, relative to the scene's folder and inside it",
           .example = R"("textures/wood.png")"});
        Placed::describe(v);
        v("scale", scale, {.help = "factor on the picture", .min = 0});
        v("invert", invert, {.help = "1 minus the scaled picture, at least 0"});
    }
};

UvTransform uvTransform(const JsonNode& node) {
    const Matrix4 m = parseTransform(node);
    return {{m[0][0], m[1][0], m[3][0], m[0][1], m[1][1], m[3][1]}};
}

Texture readBitmap(const JsonNode& node, LoadContext& context) {
    const auto p = parsePlugin<BitmapParameters>(node);
    return BitmapTexture(p, uvTransform(p.toUv), readPicture(node, context));
}

Texture readCheckerboard(const JsonNode& node, LoadContext&) {
    const auto p = parsePlugin<Placed<CheckerboardTexture::Parameters>>(node);
    return CheckerboardTexture(p, uvTransform(p.toUv));
}

Texture readRgb(const JsonNode& node, LoadContext&) { node.fail("a plain colour is no texture"); }

const PluginTable<Texture(const JsonNode&, LoadContext&)>& textureTable() {
    static const PluginTable<Texture(const JsonNode&, LoadContext&)> plugins(
        "texture", {
                       {{"bitmap", "a picture over the surface's parameters", parameterInfo<BitmapParameters>()}, readBitmap},
                       {{"checkerboard", "two colours in turn", parameterInfo<Placed<CheckerboardTexture::Parameters>>()}, readCheckerboard},
                       {{"rgb", "one colour", parameterInfo<RgbParameters>()}, readRgb},
                   });
    return plugins;
}

}  // namespace

std::vector<PluginInfo> texturePlugins() {
    return textureTable().infos();
}

Image readPicture(const JsonNode& node, LoadContext& context) {
    const auto p = parsePlugin<BitmapParameters>(node);
    Image image = context.readImage(node.at("filename"), p.raw);
    const Rgb factor(p.scale);
    if (factor == Rgb(1.0f) && !p.invert) return image;
    for (Rgb& pixel : image.pixels) {
        pixel *= factor;
        for (int c = 0; p.invert && c < 3; ++c) pixel[c] = std::max(0.0f, 1 - pixel[c]);
    }
    return image;
}

Texture readTexture(const JsonNode& node, LoadContext& context) {
    return textureTable().find(node).read(node, context);
}

void checkTexture(const Texture& texture, const JsonNode& node, const ParameterInfo& bounds) {
    dispatch(texture, [&](const auto& t) {
        const Rgb low = t.smallest(), high = t.largest();
        const float smallest = std::min({low.x, low.y, low.z}), largest = std::max({high.x, high.y, high.z});
        if (smallest < 0 && bounds.min && *bounds.min >= 0) node.fail(fmt::format("the texture holds {:g}, below 0", smallest));
        if (bounds.max && largest > *bounds.max)
            node.fail(fmt::format("the texture holds {:g}, but {} is at most {:g}", largest, bounds.name, *bounds.max));
    });
}

}  // namespace ulam
