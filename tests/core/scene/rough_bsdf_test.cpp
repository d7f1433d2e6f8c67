// Rough BSDFs: samples against densities, the limit of smooth surfaces, the law of inverses.

#include "tests/core/scene/bsdf_examples.h"
#include "tests/support/chi_square.h"

using namespace ulam;

namespace {

/// Samples on the sphere against `pdf`. Lobes must be wide against the midpoints of the test's quadrature.
template <class B>
std::optional<std::string> directionMisfit(const B& bsdf, const Vec3f& from, uint64_t seed) {
    return misfit(
        kDirections,
        [&](Random& r) -> std::optional<Sample2> {
            const auto s = bsdf.sample(from, r.nextBlock());
            return s ? std::optional(azimuthAndZ(s->to)) : std::nullopt;
        },
        [&](double phi, double z) {
            const double r = std::sqrt(std::max(0.0, 1 - z * z));
            return bsdf.pdf(Vec3d(from), Vec3d(r * std::cos(phi), r * std::sin(phi), z), Lobe::Smooth);
        },
        seed, 400'000);
}

/// Expected f |cosθ| / pdf of samples, times the colour's first channel: the reflected (and transmitted) part.
template <class B>
double sampledPower(const B& bsdf, const Vec3f& from, int samples, bool reflectedOnly = false) {
    Random random(makeKey(41), 0, 0);
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
        const auto s = bsdf.sample(from, random.nextBlock());
        if (!s || (reflectedOnly && s->to.z * from.z < 0)) continue;
        const Vec3d a(from), b(s->to);
        sum += bsdf.eval(a, b, Lobe::Smooth).x * std::abs(b.z) / bsdf.pdf(a, b, Lobe::Smooth);
    }
    return sum / samples;
}

}  // namespace

TEST_CASE("rough BSDFs: samples follow their density from either side") {
    uint64_t seed = 100;
    for (const Bsdf& any : {Bsdf(roughConductor(0.2, 3.9, "beckmann", 0.3, 0.3)), Bsdf(roughConductor(0, 1, "ggx", 0.6, 0.15)),
                            Bsdf(roughDielectric(1.5, "beckmann", 0.15, 0.4)), Bsdf(roughDielectric(1.5, "ggx", 0.3, 0.3)),
                            Bsdf(roughDielectric(1 / 1.5, "beckmann", 0.5, 0.5)), Bsdf(roughPlastic(1.5, 0.8, "beckmann", 0.3)),
                            Bsdf(roughPlastic(2, 1, "ggx", 0.15)), Bsdf(roughDiffuse(0.8, 0.5)), Bsdf(phong(0.4, 0.6, 20)),
                            Bsdf(phong(0, 1, 0)), Bsdf(ward("balanced", 0.2, 0.8, 0.3, 0.6)), Bsdf(ward("ward", 0.5, 0.5, 0.2, 0.2)),
                            Bsdf(principledCloth()), Bsdf(principledGlass(1.4, 0.7, 0.1, 0.6, 0.5)), Bsdf(principledDust())})
        dispatch(any, [&](const auto& bsdf) {
            if constexpr (std::decay_t<decltype(bsdf)>::hasSmooth)
                for (const double z : {0.95, 0.5, 0.15, -0.15, -0.7}) {
                    INFO("BSDF " << any.index() << ", cosine " << z << ", seed " << seed);
                    if (z > 0 || bsdf.transmits) CHECK_FIT(directionMisfit(bsdf, directionOf(0.8, z), seed++));
                }
        });
}

TEST_CASE("narrow lobes follow their density too") {
    // In the frame of the half vector, as slopes in units of alpha.
    const double alpha = 0.01;
    uint64_t seed = 200;
    for (const char* name : {"beckmann", "ggx"}) {
        const MicrofacetDistribution d(MicrofacetDistribution::kindOf(name), alpha, alpha);
        const auto halfSlopes = [&](const Vec3d& m) {
            return Sample2{std::atan2(m.y, m.x), std::atan(std::hypot(m.x, m.y) / (m.z * alpha))};
        };
        const auto normalAt = [&](double phi, double v) {
            const double r = std::tan(std::min(v, kPi / 2 - 1e-9));
            const Vec3d n(alpha * r * std::cos(phi), alpha * r * std::sin(phi), 1);
            return std::pair(n.normalized(), alpha * alpha * r * (1 + r * r) / std::pow(n.length(), 3));
        };
        const Domain slopes{-kPi, kPi, 0, kPi / 2, 24, 16};
        const RoughConductor metal = roughConductor(0.2, 3.9, name, alpha, alpha);
        const RoughDielectric glass = roughDielectric(1.5, name, alpha, alpha);
        for (const double z : {0.8, 0.1}) {
            INFO(name << ", cosine " << z);
            const Vec3f from = directionOf(0, z);
            const Vec3d w(from);
            CHECK_FIT(misfit(
                slopes,
                [&](Random& r) -> std::optional<Sample2> {
                    const auto s = metal.sample(from, r.nextBlock());
                    return s ? std::optional(halfSlopes(HalfVector<double>(w + Vec3d(s->to)).m)) : std::nullopt;
                },
                [&](double phi, double v) {
                    const auto [m, jacobian] = normalAt(phi, v);
                    // dω_to = 4 (w·m) dω_m
                    return metal.pdf(w, mirroredAt(w, m), Lobe::Smooth) * 4 * std::max(0.0, w.dot(m)) * jacobian;
                },
                seed++, 200'000));
            CHECK_FIT(misfit(
                slopes,
                [&](Random& r) -> std::optional<Sample2> {
                    const auto s = glass.sample(from, r.nextBlock());
                    if (!s || s->to.z > 0) return std::nullopt;
                    return halfSlopes(HalfVector<double>(w + Vec3d(s->to) * glass.ior).m);
                },
                [&](double phi, double v) {
                    const auto [m, jacobian] = normalAt(phi, v);
                    const double c = w.dot(m), cosTo = std::sqrt(1 - (1 - c * c) / (glass.ior * glass.ior));
                    if (c <= 0) return 0.0;
                    const Vec3d to = m * (c / glass.ior - cosTo) - w * (1 / glass.ior);
                    // Snell's law moved by a tilt of m (Walter et al. 2007, eq. 17).
                    return glass.pdf(w, to, Lobe::Smooth) * std::pow(c - glass.ior * cosTo, 2) /
                           (glass.ior * glass.ior * cosTo) * jacobian;
                },
                seed++, 200'000));
        }
    }
}

TEST_CASE("rough surfaces become smooth ones as alpha vanishes") {
    for (const char* name : {"beckmann", "ggx"})
        for (const double z : {1.0, 0.7, 0.3, -0.9, -0.7}) {
            INFO(name << ", cosine " << z);
            const Vec3f from = directionOf(0.5, z);
            const Vec3d mirror(reflected(Vec3d(from)));
            const RoughDielectric glass = roughDielectric(1.5, name, 1e-3, 1e-3);
            const Dielectric smoothGlass = dielectric(1.5);
            const double r = smoothGlass.probability(Vec3d(from), mirror, Lobe::DeltaReflection);
            // Four standard errors of a count, and the curvature of Fresnel's reflectance over the width of alpha.
            const int n = 200'000;
            const double error = 4 * std::sqrt(r * (1 - r) / n) + 1e-3;
            CHECK(sampledPower(glass, from, n, true) == Approx(r).margin(error));
            CHECK(sampledPower(glass, from, n) == Approx(1).margin(2e-3));
            if (z < 0) continue;
            const RoughConductor metal = roughConductor(0.2, 3.9, name, 1e-3, 1e-3);
            CHECK(sampledPower(metal, from, 1000) ==
                  Approx(conductor(0.2, 3.9).eval(mirror, Vec3d(from), Lobe::DeltaReflection).x).epsilon(2e-3));
        }
}

TEST_CASE("random numbers of an inverse have the law of the numbers that made the direction") {
    // Then those numbers are uniform again, whichever part of a mixture, or lobe, they stand for.
    uint64_t seed = 300;
    const auto check = [&](const auto& bsdf, const Vec3f& from) {
        checkNumbersOfInverse(bsdf, from, seed);
        seed += 2;
    };
    // From where hardly a sample is lost.
    const Vec3f above = directionOf(1, 0.9), below = directionOf(1, -0.95);
    check(roughPlastic(1.5, 0.8, "beckmann", 0.2), above);
    check(roughPlastic(2.4, 0.3, "beckmann", 0.1), above);
    check(roughDielectric(1.5, "beckmann", 0.1, 0.05), above);
    check(roughDielectric(1.5, "beckmann", 0.1, 0.05), below);
    check(plastic(1.5, 0.6), above);
    check(thinDielectric(2.4), above);
    check(phong(0.5, 0.4, 1000), above);
    check(ward("balanced", 0.4, 0.6, 0.05, 0.1), above);
    check(ward("ward-duer", 0.6, 0.2, 0.1, 0.1), above);
    check(Principled(principledColour({0.3, 0.2, 0.1}, 0.05)), above);
    check(principledGlass(1.5, 0.6, 0, 0.05, 0.3), above);
    check(principledGlass(1.5, 0.6, 0, 0.05, 0.3), below);
}

TEST_CASE("roughconductor: alpha stands for both axes unless they are given") {
    RoughConductor::Parameters p;
    CHECK(RoughConductor(p).alphaU == 0.1);
    CHECK_FALSE(RoughConductor(p).anisotropic());
    p.microfacets.alphaV = 0.3;
    CHECK(RoughConductor(p).alphaU == 0.1);
    CHECK(RoughConductor(p).alphaV == 0.3);
    CHECK(RoughConductor(p).anisotropic());
}

TEST_CASE("textures may replace what the list of each BSDF names") {
    const auto namesOf = [](auto* bsdf) {
        std::vector<std::string> names;
        const auto add = [&](const char* name, auto) { names.emplace_back(name); };
        std::remove_pointer_t<decltype(bsdf)>::textured(add);
        return names;
    };
    using Names = std::vector<std::string>;
    CHECK(namesOf((Diffuse*)nullptr) == Names{"reflectance"});
    CHECK(namesOf((RoughConductor*)nullptr) ==
          Names{"eta", "k", "specular_reflectance", "alpha", "alpha", "alpha_u", "alpha_v"});
    CHECK(namesOf((Null*)nullptr).empty());
    CHECK(namesOf((RoughDiffuse*)nullptr) == Names{"reflectance", "alpha"});
    CHECK(namesOf((Phong*)nullptr) == Names{"diffuse_reflectance", "specular_reflectance", "exponent"});
    CHECK(namesOf((Ward*)nullptr) == Names{"diffuse_reflectance", "specular_reflectance", "alpha", "alpha", "alpha_u", "alpha_v"});
    CHECK(namesOf((Principled*)nullptr) == Names{"base_color", "roughness", "anisotropic", "metallic", "spec_tint", "sheen", "sheen_tint",
                                                 "flatness", "clearcoat", "clearcoat_gloss"});
    // Nothing derived from them is kept: a replaced member gives the BSDF that was made with it.
    RoughConductor changed = roughConductor(0.2, 3.9, "ggx", 0.5, 0.5);
    changed.alphaU = changed.alphaV = 0.2;
    const RoughConductor made = roughConductor(0.2, 3.9, "ggx", 0.2, 0.2);
    RoughPlastic painted = roughPlastic(1.5, 0.1, "ggx", 0.3);
    const RoughPlastic white = roughPlastic(1.5, 1, "ggx", 0.3);
    painted.diffuseReflectance = white.diffuseReflectance;
    const Vec3d a = Vec3d(0.3, 0.2, 0.8).normalized(), b = Vec3d(-0.4, 0.1, 0.6).normalized();
    CHECK(changed.eval(a, b, Lobe::Smooth) == made.eval(a, b, Lobe::Smooth));
    CHECK(changed.pdf(a, b, Lobe::Smooth) == made.pdf(a, b, Lobe::Smooth));
    CHECK(painted.eval(a, b, Lobe::Smooth) == white.eval(a, b, Lobe::Smooth));
    CHECK(painted.pdf(a, b, Lobe::Smooth) == white.pdf(a, b, Lobe::Smooth));
}
