// Smooth and rough plastic: what the coat lets through, and what a white base gives back.

#include <boost/math/quadrature/gauss_kronrod.hpp>

#include "core/base/error.h"
#include "tests/core/scene/bsdf_examples.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

/// ∫ g dω over the hemisphere, for what depends on z alone and may bend at one z.
template <class Function>
double overHemisphere(Function&& g, double bend) {
    using boost::math::quadrature::gauss_kronrod;
    return 2 * kPi * (gauss_kronrod<double, 31>::integrate(g, 0, bend, 12, 1e-10) + gauss_kronrod<double, 31>::integrate(g, bend, 1, 12, 1e-10));
}
Vec3d atHeight(double z) {
    return {std::sqrt(1 - z * z), 0, z};
}

/// R(θ) as the mean of F G1 over visible normals, on a grid of their numbers that is dense towards the distribution's tails.
double reflectanceBySamples(const MicrofacetDistribution& d, double ior, bool exterior, double z, int steps) {
    double sum = 0;
    const Vec3d w = atHeight(z);
    const auto warped = [](double s) { return s * s * (3 - 2 * s); };
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double s = (i + 0.5) / steps, t = (j + 0.5) / steps, weight = 36 * s * (1 - s) * t * (1 - t);
            const Vec3d m = d.sampleVisible(w, warped(s), warped(t)), o = mirroredAt(w, m);
            if (o.z > 0) sum += weight * fresnelDielectric(w.dot(m), ior, exterior) * o.z / d.projectedArea(o);
        }
    return sum / (double(steps) * steps);
}

}  // namespace

TEST_CASE("the part of diffuse light that a coat throws back inside") {
    for (const double n : {1.0001, 1.1, 1.33, 1.5, 2.4}) {
        INFO("index " << n);
        // Reflected from outside, in closed form (Duntley 1942, "The optical properties of diffusing materials"),
        // which cancels near 1.
        const double n2 = n * n, n4 = n2 * n2;
        const double outside = 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
                               n2 * (n2 - 1) * (n2 - 1) / std::pow(n2 + 1, 3) * std::log((n - 1) / (n + 1)) -
                               2 * n * n2 * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
                               8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
        if (n > 1.01) CHECK(diffuseFresnelFromInside(1 / n) == Approx(outside).epsilon(1e-9));
        // And from inside, past the critical angle too.
        const double critical = std::sqrt(1 - 1 / n2);
        const double inside = boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
            [&](double z) { return 2 * z * fresnelDielectric(z, n, false); }, critical, 1, 12, 1e-11);
        CHECK(diffuseFresnelFromInside(n) == Approx(critical * critical + inside).epsilon(1e-7));
    }
    CHECK(diffuseFresnelFromInside(1) == Approx(0).margin(1e-15));
}

TEST_CASE("plastic: a white base gives everything back, a grey one what coat and base leave") {
    for (const double ior : {1.3, 1.49, 2.2, 0.8})
        for (const double base : {1.0, 0.6})
            for (const bool nonlinear : {false, true}) {
                const Plastic bsdf = plastic(ior, base, nonlinear);
                for (const double z : {1.0, 0.8, 0.4, 0.05}) {
                    INFO("ior " << ior << ", base " << base << ", nonlinear " << nonlinear << ", cosine " << z);
                    const double coat = bsdf.eval(atHeight(z), atHeight(z), Lobe::DeltaReflection).x;
                    CHECK(coat == Approx(fresnelDielectric(z, std::max(ior, 1 / ior), ior > 1)));
                    const double bend = ior < 1 ? std::sqrt(1 - ior * ior) : 0.5;
                    const double diffuse =
                        overHemisphere([&](double to) { return to * bsdf.eval(atHeight(z), atHeight(to), Lobe::Smooth).x; }, bend);
                    // Light that crossed the coat bounces between the base and the coat until it is lost or leaves.
                    const double inside = diffuseFresnelFromInside(ior);
                    const double left = nonlinear ? base * (1 - inside) / (1 - base * inside) : base;
                    CHECK(diffuse == Approx((1 - coat) * left).epsilon(1e-6).margin(1e-9));
                }
            }
    // Without a coat it is diffuse.
    CHECK(plastic(1, 0.6).eval(atHeight(0.4), atHeight(0.9), Lobe::Smooth).x == Approx(0.6 / kPi));
}

TEST_CASE("roughplastic: the coat's reflectance is the mean over visible normals") {
    for (const auto kind : {MicrofacetDistribution::Kind::Beckmann, MicrofacetDistribution::Kind::Ggx})
        for (const double alpha : {1e-3, 0.03, 0.3})
            for (const double ior : {1.2, 2.4})
                for (const double z : {1.0, 0.7, 0.2, alpha, 0.0})
                    for (const bool exterior : {true, false}) {
                        const MicrofacetDistribution d(kind, alpha, alpha);
                        INFO("kind " << int(kind) << ", alpha " << alpha << ", ior " << ior << ", cosine " << z << ", exterior " << exterior);
                        // The grid resolves the bend at the critical angle worse.
                        CHECK(roughReflectance(d, ior, exterior, z) ==
                              Approx(reflectanceBySamples(d, ior, exterior, z, 250)).margin(exterior ? 3e-5 : 5e-4));
                    }
}

TEST_CASE("roughplastic: the tabulated transmittance is good to 1e-4") {
    for (const auto kind : {MicrofacetDistribution::Kind::Beckmann, MicrofacetDistribution::Kind::Ggx})
        for (const double alpha : {1e-4, 1e-3, 0.02, 0.1, 1.0})
            for (const double ior : {1.02, 2.4}) {
                const MicrofacetDistribution d(kind, alpha, alpha);
                const RoughTransmittance transmittance(d, ior);
                for (int i = 0; i <= 100; ++i) {
                    // Dense where R changes over the width of alpha, and evenly.
                    for (const double z : {i / 100.0, std::min(1.0, alpha * std::expm1(i / 100.0 * std::log1p(1 / alpha)))}) {
                        INFO("kind " << int(kind) << ", alpha " << alpha << ", ior " << ior << ", cosine " << z);
                        REQUIRE(transmittance(z) == Approx(roughTransmittance(d, ior, z)).margin(1e-4));
                    }
                }
            }
}

TEST_CASE("roughplastic: transmittance is the mean over visible normals, and with reflection no more than all") {
    for (const auto kind : {MicrofacetDistribution::Kind::Beckmann, MicrofacetDistribution::Kind::Ggx})
        for (const double alpha : {1e-3, 0.03, 0.3})
            for (const double ior : {1.2, 2.4})
                for (const double z : {1.0, 0.7, 0.2, alpha}) {
                    const MicrofacetDistribution d(kind, alpha, alpha);
                    const Vec3d w(std::sqrt(1 - z * z), 0, z);
                    constexpr int kSide = 250;
                    double mean = 0;
                    // Nodes are dense at the ends, where the map to normals is singular.
                    const auto node = [](int i) {
                        const double s = (i + 0.5) / kSide;
                        return std::pair(s * s * (3 - 2 * s), 6 * s * (1 - s) / kSide);
                    };
                    for (int i = 0; i < kSide; ++i)
                        for (int j = 0; j < kSide; ++j) {
                            const auto [u, weightU] = node(i);
                            const auto [v, weightV] = node(j);
                            const Vec3d m = d.sampleVisible(w, u, v);
                            const double c = w.dot(m), below = std::sqrt(1 - (1 - c * c) / (ior * ior));
                            const Vec3d o = w / ior + m * (below - c / ior);  // turned upwards
                            if (o.z > 0) mean += (1 - fresnelDielectric(c, ior, true)) * o.z / d.projectedArea(o) * weightU * weightV;
                        }
                    INFO("kind " << int(kind) << ", alpha " << alpha << ", ior " << ior << ", cosine " << z);
                    const double t = roughTransmittance(d, ior, z);
                    CHECK(t == Approx(mean).margin(1e-4));
                    CHECK(t + roughReflectance(d, ior, true, z) <= 1 + 1e-5);
                }
}

TEST_CASE("roughplastic becomes plastic as alpha vanishes, but for the rule for diffuse light from inside") {
    const RoughPlastic rough = roughPlastic(1.49, 0.7, "ggx", 1e-4);
    Plastic smooth = plastic(1.49, 0.7);
    double rule = 0;
    for (int i = 0; i < 64; ++i) {
        const double cosTheta = 1e-6 + (1 - 1e-6) * i / 63;
        rule += 2 * cosTheta * fresnelDielectric(cosTheta, smooth.coat.ratio(), !smooth.coat.thinOutside()) / 64;
    }
    CHECK(rough.coat.internalReflectance == Approx(rule).margin(1e-3));
    CHECK(smooth.coat.internalReflectance - rule == Approx(0.011).margin(1e-3));
    smooth.coat.internalReflectance = rough.coat.internalReflectance;
    for (const double z : {1.0, 0.6, 0.2}) {
        // Away from the mirror direction only the base is left.
        const Vec3d l = atHeight(z), c = Vec3d(0, 0.8, 0.6);
        CHECK(rough.eval(l, c, Lobe::Smooth).x == Approx(smooth.eval(l, c, Lobe::Smooth).x).epsilon(1e-3));
    }
}

TEST_CASE("coats that the formulas do not hold for are refused") {
    CHECK_THROWS_AS(roughPlastic(0.9, 0.5, "ggx", 0.1), Error);
    CHECK_THROWS_AS(roughDielectric(1, "ggx", 0.1, 0.1), Error);
}
