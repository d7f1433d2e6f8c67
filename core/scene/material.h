#pragma once
// What covers a surface: a BSDF, or one for each side (`twosided`), some of its parameters textured, some of it cut out
// (`mask`).

#include "core/scene/bsdf.h"
#include "core/scene/shape.h"

#include <vector>

namespace ulam {

/// A BSDF, and which of its parameters come from textures.
struct Coating {
    struct Binding {
        int member;        ///< index in the BSDF's list `textured`
        uint32_t texture;  ///< index into Scene::textures
    };
    Bsdf bsdf;
    std::vector<Binding> bindings;
};

/// `twosided` (Mitsuba 3) reflects on both sides: directions on the back are mirrored through the surface and meet
/// `back`; its BSDFs must not transmit. Where the opacity is less than 1, the rest goes straight through.
struct Material {
    Material(Coating frontCoating, std::optional<Coating> backCoating = {}) : front(std::move(frontCoating)), back(std::move(backCoating)) {
        for (const Coating* side : {&front, back ? &*back : &front})
            dispatch(side->bsdf, [this](const auto& bsdf) {
                hasDelta |= bsdf.hasDelta;
                hasSmooth |= bsdf.hasSmooth;
            });
    }
    /// Cuts out: a constant, or a texture.
    void mask(double constant, uint32_t texture) {
        opacity = constant;
        opacityTexture = texture;
        masked = hasDelta = true;
    }

    Coating front;
    std::optional<Coating> back;
    bool masked = false;
    double opacity = 1;
    uint32_t opacityTexture = kNone;
    bool hasDelta = false, hasSmooth = false;  ///< of either side
};

}  // namespace ulam
