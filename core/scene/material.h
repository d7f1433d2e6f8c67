#pragma once
// What covers a surface: a BSDF, or one for each side (`twosided`); some of its parameters textured; mixed with others
// (`blendbsdf`, `mixturebsdf`, `mask`); under a bump map or normal map, or a dielectric coat.

#include <memory>
#include <vector>

#include "core/scene/bsdf.h"
#include "core/scene/shape.h"

namespace ulam {

struct Coating;

/// A BSDF, and which of its parameters come from textures.
struct TexturedBsdf {
    struct Binding {
        int member;        ///< index in the BSDF's list `textured`
        uint32_t texture;  ///< index into Scene::textures
    };
    Bsdf bsdf;
    std::vector<Binding> bindings;
};

/// A number in [0,1]: a constant or a texture's value, or what it leaves of 1.
struct Share {
    double constant = 1;
    uint32_t texture = kNone;
    bool rest = false;
};

/// Light meets each part with the probability of its share; what the shares leave of 1 is absorbed.
struct Mixture {
    static constexpr size_t kMaxParts = 8;
    std::vector<Coating> parts;
    std::vector<Share> shares;  ///< one a part
};

/// What is nested sees another normal: that of a height field over the surface's parameters (Blinn 1978), or one that a
/// picture holds as (n + 1) / 2 in the frame of the shading normal and ∂p/∂u.
struct Relief {
    enum class Kind : uint8_t { Heights, Normals };
    Kind kind;
    uint32_t texture;
    double scale;                 ///< factor on the heights
    std::vector<Coating> nested;  ///< one
};

/// What a rough coat needs beside its index.
struct RoughCoat {
    MicrofacetDistribution distribution;
    RoughTransmittance transmittance;
};

/// A dielectric coat over what is nested (core/path/varnish.h).
struct Varnish {
    double ior;             ///< of the coat over that outside, above 1
    Spectrum opticalDepth;  ///< absorption times thickness, straight down
    Spectrum specularReflectance;
    std::shared_ptr<const RoughCoat> rough;  ///< or null: smooth
    std::vector<Coating> nested;             ///< one
};

/// What covers one side of a surface.
struct Coating {
    std::variant<TexturedBsdf, Mixture, Relief, Varnish> layer;

    /// The BSDF of a coating that is no more than that.
    const Bsdf& bsdf() const { return std::get<TexturedBsdf>(layer).bsdf; }
};

/// Calls `function(coating)` with a coating and all that are nested in it.
template <class Function>
void forEachLayer(const Coating& coating, const Function& function) {
    function(coating);
    const auto all = [&](const std::vector<Coating>& nested) {
        for (const Coating& layer : nested) forEachLayer(layer, function);
    };
    if (const auto* mixture = std::get_if<Mixture>(&coating.layer)) all(mixture->parts);
    if (const auto* relief = std::get_if<Relief>(&coating.layer)) all(relief->nested);
    if (const auto* varnish = std::get_if<Varnish>(&coating.layer)) all(varnish->nested);
}
/// Calls `function(bsdf)` with each BSDF in a coating, as variants.
template <class Function>
void forEachBsdf(const Coating& coating, const Function& function) {
    forEachLayer(coating, [&](const Coating& layer) {
        if (const auto* plain = std::get_if<TexturedBsdf>(&layer.layer)) function(plain->bsdf);
    });
}

/// `twosided` (Mitsuba 3) reflects on both sides: directions on the back are mirrored through the surface and meet
/// `back`. Light of the lobe Null alone passes to the other side, the same share of it from either side.
struct Material {
    Material(Coating frontCoating, std::optional<Coating> backCoating = {})
        : front(std::move(frontCoating)), back(std::move(backCoating)) {
        for (const Coating* side : {&front, back ? &*back : &front})
            forEachLayer(*side, [this](const Coating& layer) {
                if (const auto* varnish = std::get_if<Varnish>(&layer.layer))
                    (varnish->rough ? hasSmooth : hasDelta) = true;
                if (const auto* plain = std::get_if<TexturedBsdf>(&layer.layer))
                    dispatch(plain->bsdf, [this](const auto& bsdf) {
                        hasDelta |= bsdf.hasDelta;
                        hasSmooth |= bsdf.hasSmooth;
                    });
            });
    }

    Coating front;
    std::optional<Coating> back;
    bool hasDelta = false, hasSmooth = false;  ///< of either side
};

}  // namespace ulam
