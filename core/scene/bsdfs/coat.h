#pragma once
// A dielectric coat over a diffuse base: what smooth and rough plastic have in common. With T(θ) the part of light that
// crosses the coat, ρ the base and R_i the part of diffuse light that the coat throws back inside, all orders of reflection
// between base and coat add up to f = T(l) T(c) ρ / (1 − ρ R_i) / (π η²). By default (`nonlinear` = false) Mitsuba 3 puts
// 1 − R_i in the denominator, so that a colour is what it says and a white base stays white.

#include "core/scene/bsdfs/scattering.h"

namespace ulam {

struct Coat {
    double ior;                  ///< interior over exterior
    double internalReflectance;  ///< R_i
    bool nonlinear;

    bool thinOutside() const { return ior > 1; }
    /// Higher over lower index.
    double ratio() const { return std::max(ior, 1 / ior); }

    /// f without the transmittances.
    Spectrum base(const Spectrum& diffuse) const {
        Spectrum f;
        for (int c = 0; c < 3; ++c)
            f[c] = diffuse[c] / (1 - (nonlinear ? diffuse[c] : 1) * internalReflectance) / (kPi * ior * ior);
        return f;
    }
};

/// Probability of sampling the coat's reflection: the coat's and the base's albedo by the parts of light they get.
template <class T>
T coatProbability(T reflectance, const Spectrum& specular, const Spectrum& diffuse) {
    const T coat = reflectance * (specular.x + specular.y + specular.z);
    const T total = coat + (T(1) - reflectance) * (diffuse.x + diffuse.y + diffuse.z);
    return total > 0 ? coat / total : T(1);
}

}  // namespace ulam
