#pragma once
// Vectors and colours are Imath's; this file names the ones used here.
// Geometry is float, everything that is multiplied up along a path is double (docs/notation.md).

#include <Imath/ImathColor.h>
#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ulam {

using Vec2f = Imath::V2f;
using Vec3f = Imath::V3f;
using Vec3d = Imath::V3d;
using Matrix4 = Imath::M44d;

/// Linear RGB; radiance, importance, throughput.
using Spectrum = Imath::Color3<double>;
/// Linear RGB as stored in images and textures.
using Rgb = Imath::Color3<float>;

inline constexpr double kPi = std::numbers::pi;

/// Relative luminance Y of linear sRGB / Rec. 709 primaries (IEC 61966-2-1).
inline double luminance(const Spectrum& c) { return 0.212671 * c.x + 0.715160 * c.y + 0.072169 * c.z; }
inline double maxComponent(const Spectrum& c) { return std::max({c.x, c.y, c.z}); }
inline bool isBlack(const Spectrum& c) { return c.x == 0 && c.y == 0 && c.z == 0; }
inline bool isFinite(const Spectrum& c) { return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z); }

inline float dot(const Vec3f& a, const Vec3f& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3f cross(const Vec3f& a, const Vec3f& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length2(const Vec3f& v) { return dot(v, v); }
inline float length(const Vec3f& v) { return std::sqrt(dot(v, v)); }
inline Vec3f normalize(const Vec3f& v) { return v * (1 / length(v)); }

}  // namespace ulam
