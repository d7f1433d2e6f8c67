#pragma once
// What every BSDF file uses. A BSDF is a plain struct with `eval`, `pdf`, `sample` and `invert` beside each other; the
// formulas take the scalar type as a template parameter, so that a path can be replayed with dual numbers.
//
// Directions are unit vectors in the local frame of the shading normal (z) and point away from the surface.
//   eval(toLight, toCamera, lobe)   f_s of radiance flowing from the light side to the camera side, without cosines
//   pdf(from, to, lobe)             density of `to` per solid angle when the walk arrived along `from`
//   probability(from, to, lobe)     the part of pdf that chooses the lobe
//   sampleLobe(from, lobe, u)       a direction of a given lobe, from u[0], u[1] and, where a lobe is a mixture, u[2]
//   sample(from, u)                 the same of a lobe chosen with u[2]; the smooth lobe has the upper end of it
//   invert(from, to, lobe, u)       u such that sample(from, u) = to; numbers that do not matter stay as they are. Many u may
//                                   give the same `to` (u[2] chooses a lobe, or a part of a mixture): random numbers in u
//                                   come back with the law of u given `to`
//   albedo()                        bounds the reflected fraction; the Russian roulette's probability of going on
//   hasDelta, hasSmooth             which lobes there may be
//   transmits                       light reaches the other side, straight on or refracted
//   smoothShare(from)               probability that sample() chooses the smooth lobe, where there are delta lobes too
//   anisotropic()                   whether the azimuth matters (absent: it does not); x then is along ∂p/∂u
//   textured(visit)                 names the members that a texture may stand for; nothing derived from them is kept, and
//                                   values out of range are clamped on use. A name listed twice stands for both members
// All of them are 0 for lobes that the BSDF has not, since it may be part of a mixture.
// For delta lobes eval and pdf are the factors of δ_σ (lobe.h).

#include "core/base/random.h"
#include "core/base/warp.h"
#include "core/scene/lobe.h"

#include <optional>

namespace ulam {

template <class T>
using Direction = Imath::Vec3<T>;
template <class T>
using Color = Imath::Color3<T>;

struct ScatterSample {
    Vec3f to;
    Lobe lobe;
};

template <class T>
Direction<T> reflected(const Direction<T>& w) {
    return {-w.x, -w.y, w.z};
}

/// Whether light of the lobe Null passes from one to the other.
template <class V>
bool goesThrough(const V& a, const V& b, Lobe lobe) {
    return lobe == Lobe::Null && a.z * b.z < 0;
}

template <class T>
Color<T> scaled(const Spectrum& c, T s) {
    return {T(c.x) * s, T(c.y) * s, T(c.z) * s};
}

/// Probability that a walk which arrived along `from` goes on by the smooth lobe.
template <class B>
double smoothShareOf(const B& bsdf, const Vec3f& from) {
    if constexpr (!B::hasSmooth) return 0;
    else if constexpr (!B::hasDelta) return 1;
    else return bsdf.smoothShare(from);
}

}  // namespace ulam
