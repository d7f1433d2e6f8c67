#pragma once
// checkerboard: two colours in turn (Mitsuba 3 `checkerboard`): color0 where both parameters' fractions lie in the same
// half of the unit interval.

#include "core/scene/textures/bitmap.h"

namespace ulam {

struct CheckerboardTexture {
    struct Parameters {
        Spectrum color0{0.4, 0.4, 0.4}, color1{0.2, 0.2, 0.2};
        template <class V>
        void describe(V& v) {
            v("color0", color0, {.help = "colour of the square at the origin", .min = 0});
            v("color1", color1, {.help = "colour of its neighbours", .min = 0});
        }
    };
    CheckerboardTexture(const Parameters& p, const UvTransform& uvTransform) : color0(p.color0), color1(p.color1), toUv(uvTransform) {}

    Spectrum color(const Vec2f& surface) const {
        const Vec2f uv = toUv(surface);
        const auto late = [](float x) { return x - std::floor(x) > 0.5f; };
        return late(uv.x) == late(uv.y) ? color0 : color1;
    }
    double value(const Vec2f& surface) const { return luminance(color(surface)); }
    /// Flat squares.
    Vec2f slope(const Vec2f&) const { return {0, 0}; }

    Rgb smallest() const { return {float(std::min(color0.x, color1.x)), float(std::min(color0.y, color1.y)), float(std::min(color0.z, color1.z))}; }
    Rgb largest() const { return {float(std::max(color0.x, color1.x)), float(std::max(color0.y, color1.y)), float(std::max(color0.z, color1.z))}; }

    Spectrum color0, color1;
    UvTransform toUv;
};

}  // namespace ulam
