#pragma once
// BSDFs of every kind, for tests of what all of them promise.

#include <vector>

#include "core/scene/bsdf.h"
#include "core/scene/bsdfs/mask.h"

namespace ulam {

inline Diffuse diffuse(double reflectance) {
    Diffuse::Parameters p;
    p.reflectance = Spectrum(reflectance, 0.5 * reflectance, 0.25 * reflectance);
    return Diffuse(p);
}
inline Conductor conductor(double eta, double k) {
    Conductor::Parameters p;
    p.eta = Spectrum(eta, 1.2 * eta, 0.8 * eta), p.k = Spectrum(k, 1.3 * k, 0.7 * k);
    return Conductor(p);
}
inline Dielectric dielectric(double inside, double outside = 1) {
    Dielectric::Parameters p;
    p.intIor = inside, p.extIor = outside;
    return Dielectric(p);
}
inline MicrofacetParameters microfacets(const char* distribution, double alphaU, double alphaV) {
    MicrofacetParameters p;
    p.distribution = distribution;
    p.alphaU = alphaU, p.alphaV = alphaV;
    return p;
}
inline RoughConductor roughConductor(double eta, double k, const char* distribution, double alphaU, double alphaV) {
    RoughConductor::Parameters p;
    p.eta = Spectrum(eta, 1.2 * eta, 0.8 * eta), p.k = Spectrum(k, 1.3 * k, 0.7 * k);
    p.microfacets = microfacets(distribution, alphaU, alphaV);
    return RoughConductor(p);
}
inline RoughDielectric roughDielectric(double ior, const char* distribution, double alphaU, double alphaV) {
    RoughDielectric::Parameters p;
    p.intIor = ior, p.extIor = 1;
    p.microfacets = microfacets(distribution, alphaU, alphaV);
    return RoughDielectric(p);
}
inline ThinDielectric thinDielectric(double inside, double outside = 1) {
    ThinDielectric::Parameters p;
    p.intIor = inside, p.extIor = outside;
    return ThinDielectric(p);
}
inline Plastic plastic(double ior, double base, bool nonlinear = false) {
    Plastic::Parameters p;
    p.intIor = ior, p.extIor = 1;
    p.diffuseReflectance = Spectrum(base, 0.5 * base, 0.25 * base);
    p.nonlinear = nonlinear;
    return Plastic(p);
}
inline RoughPlastic roughPlastic(double ior, double base, const char* distribution, double alpha, bool nonlinear = false) {
    RoughPlastic::Parameters p;
    p.intIor = ior, p.extIor = 1;
    p.diffuseReflectance = Spectrum(base, 0.5 * base, 0.25 * base);
    p.distribution = distribution;
    p.alpha = alpha;
    p.nonlinear = nonlinear;
    return RoughPlastic(p);
}

inline const std::vector<Bsdf>& bsdfs() {
    static const std::vector<Bsdf> all = {
        diffuse(0.8),
        conductor(0.2, 3.9),
        conductor(0, 1),
        conductor(2.5, 0),
        dielectric(1.5),
        dielectric(1, 1.5),
        dielectric(2.4),
        dielectric(1.0001),
        roughConductor(0.2, 3.9, "beckmann", 0.3, 0.3),
        roughConductor(0, 1, "ggx", 0.9, 0.2),
        roughDielectric(1.5, "beckmann", 0.2, 0.5),
        roughDielectric(1.5, "ggx", 0.3, 0.3),
        roughDielectric(1 / 1.5, "ggx", 0.25, 0.4),
        roughDielectric(2.4, "beckmann", 0.8, 0.8),
        thinDielectric(1.5),
        thinDielectric(1, 1.5),
        plastic(1.5, 0.8),
        plastic(1.5, 1, true),
        plastic(0.8, 0.7),
        roughPlastic(1.5, 0.8, "beckmann", 0.3),
        roughPlastic(1.5, 1, "ggx", 0.2, true),
        roughPlastic(2, 1, "ggx", 0.7),
        Null(Null::Parameters()),
    };
    return all;
}

inline Vec3f onSphere(Random& random) {
    const double u = random(), v = random();
    return squareToSphere(u, v);
}

/// η of the medium on the side of w, in units of the exterior's.
template <class B>
double indexBeside(const B& bsdf, const Vec3f& w) {
    if constexpr (std::is_same_v<B, Dielectric> || std::is_same_v<B, RoughDielectric>)
        return w.z < 0 ? bsdf.ior : 1;
    else
        return 1;
}

/// ∫ g(w) dω over the sphere, with midpoints in azimuth and z.
template <class Function>
auto overSphere(Function&& g, int steps = 400) {
    auto sum = g(Vec3d(0, 0, 1)) * 0.0;
    for (int i = 0; i < 2 * steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double z = -1 + (i + 0.5) / steps, phi = 2 * kPi * (j + 0.5) / steps, r = std::sqrt(1 - z * z);
            sum += g(Vec3d(r * std::cos(phi), r * std::sin(phi), z)) * (2 * kPi / (steps * steps));
        }
    return sum;
}

}  // namespace ulam
