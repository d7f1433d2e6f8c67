// BSDFs: samples against densities, inverses, reciprocity, energy, Fresnel, derivatives.

#include <complex>

#include "core/path/reference_factors.h"
#include "core/path/scattering.h"
#include "tests/core/scene/bsdf_examples.h"
#include "tests/support/chi_square.h"
#include "tests/support/dual.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

namespace {

/// A scene with one shape of this material, and a vertex on it with tilted shading normal.
struct Tilted {
    Scene scene;
    Vertex vertex{};

    explicit Tilted(Random& random) : scene(buildScene(pathScene("diffuse").dictionary)) {
        vertex.kind = Vertex::Kind::Surface;
        tilt(random);
    }
    void tilt(Random& random) {
        vertex.normal = onSphere(random);
        vertex.shadingNormal = normalize(vertex.normal + onSphere(random) * 0.6f);
    }
};

}  // namespace

TEST_CASE("diffuse: samples follow their density, in the local frame and in tilted ones") {
    const Diffuse bsdf = diffuse(0.8);
    const Vec3f from = normalize(Vec3f(0.3f, -0.2f, 0.4f));
    CHECK_FIT(misfit(
        kDirections,
        [&](Random& r) -> std::optional<Sample2> {
            const auto s = bsdf.sample(from, r.nextBlock());
            return s ? std::optional(azimuthAndZ(s->to)) : std::nullopt;
        },
        [&](double phi, double z) { return bsdf.pdf(Vec3d(from), Vec3d(directionOf(phi, z)), Lobe::Smooth); }, 1));
    Random random(makeKey(2), 0, 0);
    for (int i = 0; i < 4; ++i) {
        Tilted x(random);
        const From walk = i % 2 ? From::Light : From::Camera;
        const Vec3f back = normalize(x.vertex.shadingNormal + onSphere(random) * 0.5f);
        CHECK_FIT(misfit(
            kDirections,
            [&](Random& r) -> std::optional<Sample2> {
                ScatteredDirection s;
                if (!sampleScattering(x.scene, x.vertex, back, walk, r.nextBlock(), s)) return std::nullopt;
                const Vec3f &l = walk == From::Light ? back : s.direction,
                            &c = walk == From::Light ? s.direction : back;
                const Scattering again = scatter(x.scene, x.vertex, x.vertex.lobe, l, c);
                REQUIRE(again.pdf(walk) == Approx(s.scattering.pdf(walk)).epsilon(1e-4).margin(1e-6));
                REQUIRE(again.f.x == Approx(s.scattering.f.x).epsilon(1e-4));
                return azimuthAndZ(s.direction);
            },
            [&](double phi, double z) {
                const Vec3f to = directionOf(phi, z);
                const bool light = walk == From::Light;
                return scatter(x.scene, x.vertex, x.vertex.lobe, light ? back : to, light ? to : back).pdf(walk);
            },
            uint64_t(3 + i)));
    }
}

TEST_CASE("at a vertex, BSDFs agree with a second writing of their definitions") {
    Random random(makeKey(14), 0, 0);
    const auto within = [](double value, const Range& range) {
        const double slack = 1e-6 * std::abs(range.high) + 1e-12;
        return value >= range.low - slack && value <= range.high + slack;
    };
    Tilted x(random);
    Material& material = x.scene.materials[x.scene.shapes[x.vertex.shape].material];
    const Coating nothing{TexturedBsdf{Null(Null::Parameters()), {}}};
    for (const Bsdf& bsdf : bsdfs())
        for (const bool masked : {false, true}) {
            const Coating plain{TexturedBsdf{bsdf, {}}};
            material = Material(masked ? Coating{Mixture{{nothing, plain}, {{0.6}, {0.4}}}} : plain);
            int compared = 0;
            for (int i = 0; i < 2000; ++i) {
                x.tilt(random);
                // Along the normal, a tangent says little about the x axis.
                const Vec3f tangent = x.scene.shapes[x.vertex.shape].tangent(x.vertex);
                if (std::abs(dot(normalize(tangent), x.vertex.shadingNormal)) > 0.9f) continue;
                const Vec3f toLight = onSphere(random);
                ScatteredDirection s;
                if (!sampleScattering(x.scene, x.vertex, toLight, From::Light, random.nextBlock(), s)) continue;
                const Scattering found = scatter(x.scene, x.vertex, x.vertex.lobe, toLight, s.direction);
                const FactorRanges ranges = scatteringReference(x.scene, x.vertex, inDouble(toLight), inDouble(s.direction));
                const double values[] = {found.f.x, found.f.y, found.f.z, found.pdfToCamera, found.pdfToLight};
                for (size_t j = 0; j < 5; ++j) {
                    INFO("BSDF " << bsdf.index() << ", lobe " << int(x.vertex.lobe) << ", factor " << j << ": " << values[j] << " in ["
                                 << ranges[j].low << ", " << ranges[j].high << "]");
                    REQUIRE(within(values[j], ranges[j]));
                    // A range that says something.
                    if (std::abs(dot(x.vertex.normal, toLight)) > 0.1f && std::abs(dot(x.vertex.shadingNormal, toLight)) > 0.1f &&
                        std::abs(dot(x.vertex.shadingNormal, s.direction)) > 0.1f)
                        CHECK(ranges[j].high - ranges[j].low < 0.01 * ranges[j].high);
                }
                ++compared;
            }
            CHECK(compared > 50);
        }
}

TEST_CASE("nothing is sampled from the wrong side of an opaque surface") {
    Random random(makeKey(8), 0, 0);
    for (int i = 0; i < 1000; ++i) {
        Vec3f w = onSphere(random);
        w.z = -std::abs(w.z);
        for (const Bsdf& any : bsdfs())
            dispatch(any, [&](const auto& bsdf) {
                const auto s = bsdf.sample(w, random.nextBlock());
                if (!bsdf.transmits) REQUIRE_FALSE(s);
            });
    }
}

TEST_CASE("delta lobes are chosen with their probabilities and obey their laws") {
    Random random(makeKey(9), 0, 0);
    for (const double ior : {1.5, 1 / 1.5, 2.4})
        for (const double z : {1.0, 0.7, 0.3, 0.05, -0.05, -0.3, -0.7, -1.0}) {
            const Dielectric bsdf = dielectric(ior);
            const Vec3f from = directionOf(1.1, z);
            INFO("ior " << ior << ", cosine " << z);
            double counts[2] = {0, 0}, probabilities[2] = {1, 0};
            for (int i = 0; i < 100'000; ++i) {
                const auto s = bsdf.sample(from, random.nextBlock());
                REQUIRE(s);
                const bool transmitted = s->lobe == Lobe::DeltaTransmission;
                ++counts[transmitted];
                if (transmitted) {
                    probabilities[0] = bsdf.probability(Vec3d(from), Vec3d(s->to), Lobe::DeltaReflection);
                    probabilities[1] = bsdf.probability(Vec3d(from), Vec3d(s->to), Lobe::DeltaTransmission);
                    const double n1 = from.z > 0 ? 1 : ior, n2 = s->to.z > 0 ? 1 : ior;
                    REQUIRE(from.z * s->to.z < 0);
                    REQUIRE((Vec2f(from.x, from.y) * float(n1) + Vec2f(s->to.x, s->to.y) * float(n2)).length() < 1e-6f);
                    REQUIRE(length(s->to) == Approx(1).epsilon(1e-6));
                } else {
                    REQUIRE(s->to == Vec3f(-from.x, -from.y, from.z));
                }
            }
            CHECK(probabilities[0] + probabilities[1] == Approx(1));
            CHECK_FIT(misfit(counts, probabilities));
        }
}

TEST_CASE("lobes are chosen with their probabilities") {
    Random random(makeKey(13), 0, 0);
    const std::array lobes{Lobe::Smooth, Lobe::DeltaReflection, Lobe::DeltaTransmission, Lobe::Null};
    const auto check = [&](const auto& bsdf) {
        for (const double z : {1.0, 0.6, 0.1, -0.3}) {
            const Vec3f from = directionOf(2, z);
            if (z < 0 && !bsdf.transmits) continue;
            std::array<double, 4> counts{}, probabilities{};
            for (size_t i = 0; i < 4; ++i) {
                std::optional<ScatterSample> s;
                // A smooth lobe may miss; its probability is that of any direction it finds.
                for (int tries = 0; tries < 10 && !s; ++tries) s = bsdf.sampleLobe(from, lobes[i], random.nextBlock());
                if (!s) continue;
                const Vec3d a(from), b(s->to);
                probabilities[i] = bsdf.probability(a, b, lobes[i]);
                // The rest of a delta lobe's density is cosθ η².
                const double n = indexBeside(bsdf, s->to);
                if (isDelta(lobes[i])) CHECK(bsdf.pdf(a, b, lobes[i]) == Approx(probabilities[i] * n * n * std::abs(b.z)));
            }
            for (int i = 0; i < 100'000; ++i)
                if (const auto s = bsdf.sample(from, random.nextBlock())) ++counts[size_t(s->lobe)];
            if (!bsdf.hasDelta) continue;
            CHECK_FIT(misfit(counts, probabilities));
            if constexpr (requires { bsdf.smoothShare(from); })
                CHECK(bsdf.smoothShare(from) == Approx(probabilities[0]));
            else
                CHECK_FALSE((bsdf.hasDelta && bsdf.hasSmooth));
        }
    };
    for (const Bsdf& any : bsdfs()) dispatch(any, check);
}

TEST_CASE("a BSDF does nothing by lobes that it has not") {
    Random random(makeKey(15), 0, 0);
    for (const Bsdf& any : bsdfs())
        dispatch(any, [&](const auto& bsdf) {
            for (const Lobe lobe : {Lobe::Smooth, Lobe::DeltaReflection, Lobe::DeltaTransmission, Lobe::Null}) {
                bool has = false;
                for (int i = 0; i < 200; ++i) has |= bsdf.sampleLobe(onSphere(random), lobe, random.nextBlock()).has_value();
                INFO("BSDF " << any.index() << ", lobe " << int(lobe));
                CHECK((isDelta(lobe) ? bsdf.hasDelta : bsdf.hasSmooth) >= has);
                if (has) continue;
                for (int i = 0; i < 200; ++i) {
                    const Vec3d a(onSphere(random)), b(i % 2 ? Vec3d(onSphere(random)) : i % 4 ? -a : reflected(a));
                    REQUIRE(isBlack(bsdf.eval(a, b, lobe)));
                    REQUIRE(bsdf.pdf(a, b, lobe) == 0);
                    REQUIRE(bsdf.probability(a, b, lobe) == 0);
                    Block u{};
                    REQUIRE_FALSE(bsdf.invert(Vec3f(a), Vec3f(b), lobe, u));
                }
            }
        });
}

TEST_CASE("the numbers of a direction give the direction again") {
    Random random(makeKey(10), 0, 0);
    for (const Bsdf& any : bsdfs())
        dispatch(any, [&](const auto& bsdf) {
            int inverted = 0;
            for (int i = 0; i < 20'000; ++i) {
                const Vec3f from = onSphere(random);
                const auto s = bsdf.sample(from, random.nextBlock());
                if (!s) continue;
                Block u = random.nextBlock();
                REQUIRE(bsdf.invert(from, s->to, s->lobe, u));
                for (const double number : u) REQUIRE((number >= 0 && number <= 1));
                const auto again = bsdf.sample(from, u);
                REQUIRE(again);
                REQUIRE(again->lobe == s->lobe);
                REQUIRE(length(again->to - s->to) < 1e-5f);
                ++inverted;
            }
            CHECK(inverted > 5'000);
            Block u{};
            CHECK_FALSE(bsdf.invert({0, 0, 1}, {0, 0, 1}, Lobe::DeltaTransmission, u));
        });
}

TEST_CASE("BSDFs are reciprocal up to the squared index of the medium") {
    Random random(makeKey(11), 0, 0);
    for (const Bsdf& any : bsdfs())
        dispatch(any, [&](const auto& bsdf) {
            for (int i = 0; i < 20'000; ++i) {
                const Vec3f a = onSphere(random);
                const auto s = bsdf.sample(a, random.nextBlock());
                if (!s) continue;
                // f(l → c) / η_c² = f(c → l) / η_l² (lobe.h)
                const double na = indexBeside(bsdf, a), nb = indexBeside(bsdf, s->to);
                const Spectrum f = bsdf.eval(Vec3d(a), Vec3d(s->to), s->lobe),
                               g = bsdf.eval(Vec3d(s->to), Vec3d(a), s->lobe);
                for (int c = 0; c < 3; ++c) REQUIRE(f[c] / (nb * nb) == Approx(g[c] / (na * na)).epsilon(1e-5));
                REQUIRE(f.x >= 0);
            }
        });
}

TEST_CASE("no BSDF reflects more than it receives, and none more than its albedo") {
    for (const Bsdf& any : bsdfs())
        dispatch(any, [&](const auto& bsdf) {
            for (const double z : {1.0, 0.9, 0.5, 0.1, 0.01, -0.01, -0.5, -1.0}) {
                INFO("BSDF " << any.index() << ", cosine " << z);
                // Of the light from one direction, the parts of power that the lobes take: of a delta lobe f / η² on its
                // side, else ∫ f |cosθ| dω.
                const Vec3f from = directionOf(0.4, z);
                Spectrum sum(0.0);
                for (const Lobe lobe : {Lobe::DeltaReflection, Lobe::DeltaTransmission, Lobe::Null}) {
                    const auto s = bsdf.sampleLobe(from, lobe, Block{});
                    if (!s) continue;
                    const double n = indexBeside(bsdf, s->to);
                    sum += bsdf.eval(Vec3d(from), Vec3d(s->to), lobe) / (n * n);
                }
                if (bsdf.hasSmooth)
                    sum += overSphere([&](const Vec3d& to) { return bsdf.eval(Vec3d(from), to, Lobe::Smooth) * std::abs(to.z); });
                CHECK(maxComponent(sum) <= bsdf.albedo() * (1 + 2e-5));
                using B = std::decay_t<decltype(bsdf)>;
                if constexpr (std::is_same_v<B, Diffuse>)
                    for (int c = 0; c < 3; ++c) CHECK(sum[c] == Approx(z > 0 ? bsdf.reflectance[c] : 0).epsilon(1e-5));
                if constexpr (std::is_same_v<B, Dielectric> || std::is_same_v<B, ThinDielectric> || std::is_same_v<B, Null>)
                    CHECK(sum.x == Approx(1).epsilon(1e-6));
            }
        });
}

TEST_CASE("Fresnel: known values of dielectrics") {
    for (const double n : {1.1, 1.33, 1.5046, 2.4}) {
        INFO("index " << n);
        const double normal = (n - 1) * (n - 1) / ((n + 1) * (n + 1));
        CHECK(fresnelFromThinSide(1.0, n) == Approx(normal));
        CHECK(fresnelFromThinSide(0.0, n) == Approx(1));
        // Brewster's angle, tan θ = n: nothing of the parallel part, ((n²−1)/(n²+1))² of the other.
        const double brewster = 1 / std::sqrt(1 + n * n), s = (n * n - 1) / (n * n + 1);
        CHECK(fresnelFromThinSide(brewster, n) == Approx(s * s / 2));
        // Total reflection from inside beyond the critical angle, sin θ = 1/n, and not before.
        const double critical = std::sqrt(1 - 1 / (n * n));
        CHECK(cosThinFromDense(critical * 0.999, n) < 0);
        CHECK(cosThinFromDense(critical * 1.001, n) > 0);
        CHECK(cosThinFromDense(1.0, n) == Approx(1));
        const Dielectric glass = dielectric(n);
        const Vec3d inside(std::sqrt(1 - critical * critical * 0.99), 0, -critical * std::sqrt(0.99)),
            mirrored(-inside.x, 0, inside.z);
        CHECK(glass.eval(inside, mirrored, Lobe::DeltaReflection).x == Approx(n * n));
        CHECK_FALSE(glass.sampleLobe(Vec3f(inside), Lobe::DeltaTransmission, Block{}));
        // The same ray from either side.
        const Vec3f outside = directionOf(0.3, 0.6);
        const auto refracted = glass.sampleLobe(outside, Lobe::DeltaTransmission, Block{});
        REQUIRE(refracted);
        CHECK(glass.probability(Vec3d(outside), Vec3d(refracted->to), Lobe::DeltaReflection) ==
              Approx(glass.probability(Vec3d(refracted->to), Vec3d(outside), Lobe::DeltaReflection)));
    }
}

TEST_CASE("Fresnel: conductors agree with the complex amplitudes") {
    using Complex = std::complex<double>;
    for (const auto& [eta, k] : {std::pair(0.2004, 3.9129), {1.5, 0.0}, {0.0, 1.0}, {3.1, 3.3}, {0.05, 0.4}})
        for (const double c : {1.0, 0.8, 0.4, 0.1, 0.001}) {
            INFO("n = " << eta << " + " << k << "i, cosine " << c);
            const Complex n(eta, k), sinT = std::sqrt(1 - c * c) / n, cosT = std::sqrt(1.0 - sinT * sinT);
            const Complex rs = (c - n * cosT) / (c + n * cosT), rp = (n * c - cosT) / (n * c + cosT);
            // The root's branch does not matter to |r|² < 1 only if the transmitted wave decays: take the smaller.
            const auto smaller = [](const Complex& r) { return std::min(std::norm(r), 1 / std::norm(r)); };
            CHECK(fresnelConductor(c, eta, k) == Approx((smaller(rs) + smaller(rp)) / 2).epsilon(1e-9));
        }
    // A conductor without absorption is a dielectric.
    CHECK(fresnelConductor(0.6, 1.5, 0) == Approx(fresnelFromThinSide(0.6, 1.5)));
    CHECK(fresnelConductor(0.3, 0, 1) == Approx(1));
}

TEST_CASE("dual numbers give the derivatives of BSDFs and their densities") {
    Random random(makeKey(12), 0, 0);
    const auto path = [](const Vec3d& at, const Vec3d& velocity, auto t) {
        using T = decltype(t);
        return Direction<T>(T(at.x) + T(velocity.x) * t, T(at.y) + T(velocity.y) * t, T(at.z) + T(velocity.z) * t);
    };
    for (const Bsdf& any : bsdfs())
        dispatch(any, [&](const auto& bsdf) {
            int compared = 0;
            for (int i = 0; i < 300; ++i) {
                const Vec3f a = onSphere(random);
                const auto s = bsdf.sample(a, random.nextBlock());
                if (!s || std::abs(a.z) < 0.05 || std::abs(s->to.z) < 0.05) continue;
                const Vec3d da(onSphere(random)), db(onSphere(random)), b(s->to), from(a);
                const auto values = [&](auto t) {
                    const auto l = path(from, da, t), c = path(b, db, t);
                    const auto f = bsdf.eval(l, c, s->lobe);
                    return std::array{f.x, f.y, f.z, bsdf.pdf(l, c, s->lobe), bsdf.probability(l, c, s->lobe)};
                };
                const double h = 1e-6;
                const auto dual = values(Dual(0, 1));
                const auto plain = values(0.0), up = values(h), down = values(-h);
                for (size_t j = 0; j < dual.size(); ++j) {
                    REQUIRE(dual[j].v == plain[j]);
                    REQUIRE(dual[j].d == Approx((up[j] - down[j]) / (2 * h)).epsilon(1e-5).margin(1e-6));
                }
                ++compared;
            }
            CHECK(compared > 50);
        });
    for (const double c : {0.2, 0.9}) {
        const double h = 1e-6;
        CHECK(cosineHemispherePdf(Dual(c, 1)).d ==
              Approx((cosineHemispherePdf(c + h) - cosineHemispherePdf(c - h)) / (2 * h)));
        CHECK(fresnelConductor(Dual(c, 1), 0.2, 3.9).d ==
              Approx((fresnelConductor(c + h, 0.2, 3.9) - fresnelConductor(c - h, 0.2, 3.9)) / (2 * h)).epsilon(1e-6));
        CHECK(fresnelFromThinSide(Dual(c, 1), 1.5).d ==
              Approx((fresnelFromThinSide(c + h, 1.5) - fresnelFromThinSide(c - h, 1.5)) / (2 * h)).epsilon(1e-6));
    }
}
