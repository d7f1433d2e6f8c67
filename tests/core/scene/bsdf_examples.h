#pragma once
// BSDFs of every kind, for tests of what all of them promise.

#include <vector>

#include "core/scene/bsdf.h"
#include "core/scene/bsdfs/principled_formulas.h"
#include "tests/support/chi_square.h"

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

inline RoughDiffuse roughDiffuse(double reflectance, double alpha, bool qualitative = false) {
    RoughDiffuse::Parameters p;
    p.reflectance = Spectrum(reflectance, 0.5 * reflectance, 0.02 * reflectance);
    p.alpha = alpha, p.useFastApprox = qualitative;
    return RoughDiffuse(p);
}
inline Phong phong(double base, double gloss, double exponent) {
    Phong::Parameters p;
    p.diffuseReflectance = Spectrum(base, 0.5 * base, 0.25 * base), p.specularReflectance = Spectrum(gloss, 0.8 * gloss, gloss);
    p.exponent = exponent;
    return Phong(p);
}
inline Ward ward(const char* variant, double base, double gloss, double alphaU, double alphaV) {
    Ward::Parameters p;
    p.variant = variant;
    p.diffuseReflectance = Spectrum(base, 0.5 * base, 0.25 * base), p.specularReflectance = Spectrum(gloss, 0.8 * gloss, gloss);
    p.alphaU = alphaU, p.alphaV = alphaV;
    return Ward(p);
}
inline Principled::Parameters principledColour(const Spectrum& color, double roughness) {
    Principled::Parameters p;
    p.baseColor = color;
    p.roughness = roughness;
    return p;
}
/// Every lobe but refraction.
inline Principled principledCloth() {
    auto p = principledColour({0.8, 0.4, 0.1}, 0.4);
    p.anisotropic = 0.7, p.metallic = 0.3, p.specular = 0.8, p.specTint = 0.6, p.sheen = 0.9, p.sheenTint = 0.4;
    p.flatness = 0.5, p.clearcoat = 0.8, p.clearcoatGloss = 0.2;
    return Principled(p);
}
inline Principled principledMetal(double roughness) {
    auto p = principledColour({0.8, 0.4, 0.1}, roughness);
    p.metallic = 1;
    return Principled(p);
}
inline Principled principledGlass(double eta, double refraction, double metallic, double roughness, double anisotropic) {
    auto p = principledColour({0.8, 0.4, 0.1}, roughness);
    p.eta = eta, p.specTrans = refraction, p.metallic = metallic, p.anisotropic = anisotropic;
    return Principled(p);
}
/// Lighter inside than outside, with a clearcoat.
inline Principled principledBubble() {
    auto p = principledColour({0.8, 0.4, 0.1}, 0.7);
    p.eta = 0.8, p.specTrans = 0.5, p.clearcoat = 1, p.specTint = 0.5;
    return Principled(p);
}
/// The roughest, and black but for sheen and clearcoat.
inline Principled principledDust() {
    auto p = principledColour({0, 0, 0}, 1);
    p.anisotropic = 1, p.specular = 0, p.flatness = 1, p.sheen = 1, p.clearcoat = 1, p.clearcoatGloss = 0.5;
    return Principled(p);
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
        roughDiffuse(1, 0.47),
        roughDiffuse(0.5, 1),
        roughDiffuse(0.8, 0, true),
        roughDiffuse(1, 0.3, true),
        phong(0.5, 0.5, 30),
        phong(0, 1, 0),
        phong(0.9, 0.1, 1000),
        phong(0.5, 0, 5),
        ward("balanced", 0.4, 0.6, 0.6, 0.4),
        ward("balanced", 0, 1, 1, 1),
        ward("ward", 0.5, 0.5, 0.2, 0.2),
        ward("ward-duer", 0.7, 0.3, 0.2, 0.5),
        Principled(principledColour({0.8, 0.4, 0.1}, 0.5)),
        Principled(principledColour({1, 1, 1}, 1)),
        principledCloth(),
        principledMetal(0.3),
        principledGlass(1.4, 0.7, 0.1, 0.6, 0.5),
        principledGlass(1.5, 1, 0, 0.4, 0),
        principledBubble(),
        principledDust(),
    };
    return all;
}

/// Random numbers of an inverse have the law of the numbers that made the direction: those numbers are uniform again,
/// whichever part of a mixture, or lobe, they stand for. From where hardly a sample is lost.
template <class B>
void checkNumbersOfInverse(const B& bsdf, const Vec3f& from, uint64_t seed) {
    for (const size_t other : {0, 1}) {
        INFO("numbers 2 and " << other << ", seed " << seed + other);
        CHECK_FIT(misfit(
            Domain{0, 1, 0, 1, 20, 40},
            [&](Random& r) -> std::optional<Sample2> {
                std::optional<ScatterSample> s;
                while (!s) s = bsdf.sample(from, r.nextBlock());
                Block u = r.nextBlock();
                REQUIRE(bsdf.invert(from, s->to, s->lobe, u));
                return Sample2{u[other], u[2]};
            },
            [](double, double) { return 1; }, seed + other, 200'000));
    }
}

inline Vec3f onSphere(Random& random) {
    const double u = random(), v = random();
    return squareToSphere(u, v);
}

/// η of the medium on the side of w, in units of the exterior's.
template <class B>
double indexBeside(const B& bsdf, const Vec3f& w) {
    if constexpr (std::is_same_v<B, Dielectric> || std::is_same_v<B, RoughDielectric> || std::is_same_v<B, Principled>)
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
