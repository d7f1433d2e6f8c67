#pragma once
// All BSDFs, and the one dispatch to them.

#include "core/scene/bsdfs/conductor.h"
#include "core/scene/bsdfs/dielectric.h"
#include "core/scene/bsdfs/diffuse.h"
#include "core/scene/bsdfs/mask.h"

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

}  // namespace ulam
