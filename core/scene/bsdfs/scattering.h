#pragma once
// What every BSDF file uses. A BSDF is a plain struct with `eval`, `pdf`, `sample` and `invert` beside each other; the
// formulas take the scalar type as a template parameter, so that a path can be replayed with dual numbers.
//
// Directions are unit vectors in the local frame of the shading normal (z) and point away from the surface.
//   eval(toLight, toCamera, lobe)   f_s of radiance flowing from the light side to the camera side, without cosines
//   pdf(from, to, lobe)             density of `to` per solid angle when the walk arrived along `from`
//   probability(from, to, lobe)     the part of pdf that chooses the lobe
//   sampleLobe(from, lobe, u)       a direction of a given lobe, from u[0], u[1]
//   sample(from, u)                 the same of a lobe chosen with u[2]
//   invert(from, to, lobe, u)       u such that sample(from, u) = to; numbers that do not matter stay as they are
//   albedo()                        bounds the reflected fraction; the Russian roulette's probability of going on
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

template <class T>
Color<T> scaled(const Spectrum& c, T s) {
    return {T(c.x) * s, T(c.y) * s, T(c.z) * s};
}

}  // namespace ulam
