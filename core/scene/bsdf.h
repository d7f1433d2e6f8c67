#pragma once
// All BSDFs, and the one dispatch to them.

#include "core/scene/bsdfs/conductor.h"
#include "core/scene/bsdfs/dielectric.h"
#include "core/scene/bsdfs/diffuse.h"
#include "core/scene/bsdfs/null.h"
#include "core/scene/bsdfs/phong.h"
#include "core/scene/bsdfs/plastic.h"
#include "core/scene/bsdfs/principled.h"
#include "core/scene/bsdfs/roughconductor.h"
#include "core/scene/bsdfs/roughdielectric.h"
#include "core/scene/bsdfs/roughdiffuse.h"
#include "core/scene/bsdfs/roughplastic.h"
#include "core/scene/bsdfs/thindielectric.h"
#include "core/scene/bsdfs/ward.h"

#include <variant>

namespace ulam {

using Bsdf = std::variant<Diffuse, Conductor, Dielectric, RoughConductor, RoughDielectric, ThinDielectric, Plastic, RoughPlastic, Null,
                          RoughDiffuse, Phong, Ward, Principled>;

/// Calls `function` with the BSDF's own type: a switch, no virtual call.
template <class Function>
decltype(auto) dispatch(const Bsdf& bsdf, Function&& function) {
    static_assert(std::variant_size_v<Bsdf> == 13);
    switch (bsdf.index()) {
        case 0: return function(*std::get_if<0>(&bsdf));
        case 1: return function(*std::get_if<1>(&bsdf));
        case 2: return function(*std::get_if<2>(&bsdf));
        case 3: return function(*std::get_if<3>(&bsdf));
        case 4: return function(*std::get_if<4>(&bsdf));
        case 5: return function(*std::get_if<5>(&bsdf));
        case 6: return function(*std::get_if<6>(&bsdf));
        case 7: return function(*std::get_if<7>(&bsdf));
        case 8: return function(*std::get_if<8>(&bsdf));
        case 9: return function(*std::get_if<9>(&bsdf));
        case 10: return function(*std::get_if<10>(&bsdf));
        case 11: return function(*std::get_if<11>(&bsdf));
        default: return function(*std::get_if<12>(&bsdf));
    }
}

}  // namespace ulam
