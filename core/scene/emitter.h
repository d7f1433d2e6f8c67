#pragma once
// All emitters, and the one dispatch to them.

#include "core/scene/emitters/area.h"
#include "core/scene/emitters/constant.h"
#include "core/scene/emitters/point.h"

#include <variant>

namespace ulam {

using Emitter = std::variant<AreaEmitter, PointEmitter, ConstantEmitter>;

template <class Function>
decltype(auto) dispatch(const Emitter& emitter, Function&& function) {
    if (const auto* area = std::get_if<AreaEmitter>(&emitter)) return function(*area);
    if (const auto* point = std::get_if<PointEmitter>(&emitter)) return function(*point);
    return function(std::get<ConstantEmitter>(emitter));
}

}  // namespace ulam
