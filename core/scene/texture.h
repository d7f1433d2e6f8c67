#pragma once
// All textures: what may stand in the place of a colour or a number.

#include "core/base/non_finite.h"
#include "core/scene/textures/bitmap.h"
#include "core/scene/textures/checkerboard.h"

#include <variant>

namespace ulam {

using Texture = std::variant<BitmapTexture, CheckerboardTexture>;

template <class Function>
decltype(auto) dispatch(const Texture& texture, Function&& function) {
    if (const auto* bitmap = std::get_if<BitmapTexture>(&texture)) return function(*bitmap);
    return function(std::get<CheckerboardTexture>(texture));
}

/// The value at the surface parameters (u, v) of a vertex (Shape::texcoord).
inline Spectrum textureColor(const Texture& texture, const Vec2f& uv) {
    const Spectrum color = dispatch(texture, [&](const auto& t) { return t.color(uv); });
    return checkFinite(Cause::Texture, color.x + color.y + color.z) ? color : Spectrum(0.0);
}
/// ∂/∂u and ∂/∂v of textureValue.
inline Vec2f textureSlope(const Texture& texture, const Vec2f& uv) {
    return dispatch(texture, [&](const auto& t) { return t.slope(uv); });
}
inline double textureValue(const Texture& texture, const Vec2f& uv) {
    const double value = dispatch(texture, [&](const auto& t) { return t.value(uv); });
    return checkFinite(Cause::Texture, value) ? value : 0;
}

}  // namespace ulam
