#pragma once
// The factors of f and of the densities straight from their definitions, in double and without any code of the
// renderer: what the validator compares a path's factors with.
//
// Results are ranges: a cosine that was computed in float is known up to kCosineError, and near grazing or critical
// angles that is a lot. Every formula is evaluated at both ends.

#include <array>

#include "core/path/tracing.h"

namespace ulam {

/// How far a float dot product of unit vectors may be off.
inline constexpr double kCosineError = 1e-6;

struct Range {
    double low, high;
};

/// f (three colours), density towards the camera, density towards the light; in the order of `Scattering`.
using FactorRanges = std::array<Range, 5>;

/// A point or, at infinity, a unit direction.
inline Vec3d inDouble(const Vec3f& v) {
    return Vec3d(v.x, v.y, v.z);
}

/// Unit direction from a to b from their positions.
Vec3d exactDirection(const Vertex& a, const Vertex& b);
/// 1 / |a − b|²; 1 where an end lies at infinity.
double exactInverseD2(const Vertex& a, const Vertex& b);
/// |cosθ| of a direction with the geometric normal; 1 without a surface.
double exactCosine(const Vertex& v, const Vec3d& w);

/// f̂_s and both densities at an inner vertex (delta lobes: factors of δ_σ, lobe.h).
FactorRanges scatteringReference(const Scene& scene, const Vertex& v, const Vec3d& toLight, const Vec3d& toCamera);
/// L_e and the density of the direction w at x_0.
FactorRanges emissionReference(const Scene& scene, const Vertex& x0, const Vec3d& w);
/// W_e(w) and the density of w at x_k.
FactorRanges importanceReference(const Scene& scene, const Vertex& lens, const Vec3d& w);

/// How far two directions at a delta vertex are from the law of its lobe: |reflect(l) − c|, |l + c|, or |η_l l_t + η_c c_t|
/// with the tangential parts and indices in units of the exterior's; 0 for other lobes.
double deltaLawError(const Scene& scene, const Vertex& v, const Vec3d& toLight, const Vec3d& toCamera);

}  // namespace ulam
