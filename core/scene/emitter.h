#pragma once
// All emitters, and the one dispatch to them.

#include "core/scene/emitters/area.h"
#include "core/scene/emitters/constant.h"
#include "core/scene/emitters/directional.h"
#include "core/scene/emitters/envmap.h"
#include "core/scene/emitters/point.h"
#include "core/scene/emitters/spot.h"

#include <variant>

namespace ulam {

using Emitter = std::variant<AreaEmitter, PointEmitter, ConstantEmitter, EnvmapEmitter, SpotEmitter, DirectionalEmitter>;

template <class Function>
decltype(auto) dispatch(const Emitter& emitter, Function&& function) {
    switch (emitter.index()) {
        case 0:
            return function(*std::get_if<0>(&emitter));
        case 1:
            return function(*std::get_if<1>(&emitter));
        case 2:
            return function(*std::get_if<2>(&emitter));
        case 3:
            return function(*std::get_if<3>(&emitter));
        case 4:
            return function(*std::get_if<4>(&emitter));
        default:
            return function(*std::get_if<5>(&emitter));
    }
}

/// Does it surround the scene? Of these there is at most one.
inline bool isEnvironment(const Emitter& emitter) {
    return std::holds_alternative<ConstantEmitter>(emitter) || std::holds_alternative<EnvmapEmitter>(emitter);
}

}  // namespace ulam
