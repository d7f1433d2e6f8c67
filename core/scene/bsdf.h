#pragma once
// All BSDFs, the one dispatch to them, and what covers a surface: one BSDF, or one for each side (`twosided`).

#include "core/scene/bsdfs/conductor.h"
#include "core/scene/bsdfs/dielectric.h"
#include "core/scene/bsdfs/diffuse.h"

#include <variant>

namespace ulam {

using Bsdf = std::variant<Diffuse, Conductor, Dielectric>;

/// Calls `function` with the BSDF's own type: a switch, no virtual call.
template <class Function>
decltype(auto) dispatch(const Bsdf& bsdf, Function&& function) {
    if (const auto* diffuse = std::get_if<Diffuse>(&bsdf)) return function(*diffuse);
    if (const auto* dielectric = std::get_if<Dielectric>(&bsdf)) return function(*dielectric);
    return function(std::get<Conductor>(bsdf));
}

/// The covering of a surface. `twosided` (Mitsuba 3) reflects on both sides: directions on the back are mirrored through
/// the surface and meet `back`; its BSDFs must not transmit.
struct Material {
    Bsdf front;
    std::optional<Bsdf> back;

    /// Calls `function(bsdf, mirrored)` with the BSDF on the side of a direction with this cosine to the shading normal.
    template <class Function>
    decltype(auto) onSideOf(float cosTheta, Function&& function) const {
        const bool mirrored = back && !(cosTheta > 0);
        return dispatch(mirrored ? *back : front, [&](const auto& bsdf) { return function(bsdf, mirrored); });
    }

    /// Of either side.
    bool hasDelta() const {
        auto delta = [](const Bsdf& b) { return dispatch(b, [](const auto& bsdf) { return bsdf.hasDelta; }); };
        return delta(front) || (back && delta(*back));
    }
    bool hasSmooth() const {
        auto smooth = [](const Bsdf& b) { return dispatch(b, [](const auto& bsdf) { return bsdf.hasSmooth; }); };
        return smooth(front) || (back && smooth(*back));
    }
};

}  // namespace ulam
