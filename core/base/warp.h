#pragma once
// Maps from uniform numbers to the distributions used for sampling, each with its density and its inverse.
// Densities of directions are per solid angle, of points per area.

#include "core/base/vector.h"

namespace ulam {

struct Sample2 {
    double u, v;
};

/// An orthonormal basis around a unit vector (Duff et al. 2017, "Building an orthonormal basis, revisited"). Always inlined:
/// what a caller does not use of it is never computed.
struct Frame {
    Vec3f s, t, n;

    [[gnu::always_inline]] explicit Frame(const Vec3f& normal) : n(normal) {
        const float sign = std::copysign(1.0f, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
        s = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
        t = {b, sign + n.y * n.y * a, -n.y};
    }
    /// With s along a given tangent, which need be neither unit nor orthogonal.
    Frame(const Vec3f& normal, const Vec3f& tangent) : n(normal) {
        const Vec3f across = tangent - normal * dot(normal, tangent);
        if (!(length2(across) > 1e-12f * length2(tangent))) {
            *this = Frame(normal);
            return;
        }
        s = normalize(across);
        t = cross(n, s);
    }
    [[gnu::always_inline]] Vec3f toLocal(const Vec3f& v) const { return {dot(v, s), dot(v, t), dot(v, n)}; }
    [[gnu::always_inline]] Vec3f toWorld(const Vec3f& v) const { return s * v.x + t * v.y + n * v.z; }
};

/// The azimuth of (x, y) as a number in [0, 1).
inline double inverseAzimuth(double x, double y) {
    const double v = std::atan2(y, x) / (2 * kPi);
    return v < 0 ? v + 1 : v;
}

/// Unit disc, uniform.
inline Vec2f squareToDisc(double u, double v) {
    const float r = float(std::sqrt(u)), phi = float(2 * kPi * v);
    return {r * std::cos(phi), r * std::sin(phi)};
}
inline Sample2 discToSquare(double x, double y) { return {std::min(1.0, x * x + y * y), inverseAzimuth(x, y)}; }

/// Hemisphere around +z with density cosθ/π.
inline Vec3f squareToCosineHemisphere(double u, double v) {
    const Vec2f d = squareToDisc(u, v);
    return {d.x, d.y, float(std::sqrt(1 - u))};
}
template <class T>
T cosineHemispherePdf(T cosTheta) {
    return cosTheta > 0 ? cosTheta * (1 / kPi) : T(0);
}
inline Sample2 cosineHemisphereToSquare(const Vec3f& w) {
    Sample2 s = discToSquare(w.x, w.y);
    // Near the horizon only z knows how near.
    if (s.u > 0.5) s.u = 1 - double(w.z) * w.z;
    return s;
}

/// Whole sphere, uniform: density 1/(4π).
inline Vec3f squareToSphere(double u, double v) {
    const double z = 1 - 2 * u, r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * kPi * v;
    return {float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
}
inline constexpr double kSpherePdf = 1 / (4 * kPi);
inline Sample2 sphereToSquare(const Vec3f& w) {
    // (1 − |z|) / 2 from x and y, which alone know it near the poles.
    const double r2 = double(w.x) * w.x + double(w.y) * w.y, polar = std::min(0.5, r2 / (2 * (1 + std::abs(double(w.z)))));
    return {w.z > 0 ? polar : 1 - polar, inverseAzimuth(w.x, w.y)};
}

/// Barycentric coordinates (of the second and third corner), uniform over a triangle.
inline Vec2f squareToTriangle(double u, double v) {
    const double r = std::sqrt(u);
    return {float(r * (1 - v)), float(r * v)};
}
inline Sample2 triangleToSquare(const Vec2f& b) {
    const double r = std::min(1.0, double(b.x) + b.y);
    return {r * r, r > 0 ? b.y / r : 0.0};
}

/// Standard normal deviate (Box–Muller, one of the two).
inline double squareToNormal(double u, double v) { return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * v); }

}  // namespace ulam
