// roughdiffuse, phong and ward against closed forms and integrals of the published formulas, principled against Mitsuba 3.

#include <boost/math/quadrature/gauss_kronrod.hpp>

#include "core/base/error.h"
#include "tests/core/scene/bsdf_examples.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

template <class Function>
double integral(Function&& g, double a, double b) {
    return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(g, a, b, 12, 1e-11);
}
Vec3d at(double theta, double phi = 0) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// The part of the light from `from` that is reflected, first colour. For what is symmetric about the plane of incidence, which
/// is y = 0, and may bend where both angles are the same, and at right angles to the plane.
template <class B>
double reflectedPart(const B& bsdf, double theta) {
    const auto overAzimuth = [&](double t) {
        const auto f = [&](double phi) { return bsdf.eval(at(theta), at(t, phi), Lobe::Smooth).x; };
        return 2 * (integral(f, 0, kPi / 2) + integral(f, kPi / 2, kPi)) * std::cos(t) * std::sin(t);
    };
    return (theta > 0 ? integral(overAzimuth, 0, theta) : 0) + integral(overAzimuth, theta, kPi / 2);
}

}  // namespace

TEST_CASE("roughdiffuse without roughness is diffuse") {
    Random random(makeKey(61), 0, 0);
    RoughDiffuse::Parameters p;
    p.reflectance = Spectrum(0.9, 0.5, 0);
    p.alpha = 0;
    Diffuse::Parameters same;
    same.reflectance = p.reflectance;
    for (const bool qualitative : {false, true})
        for (int i = 0; i < 1000; ++i) {
            p.useFastApprox = qualitative;
            const Vec3d l(onSphere(random)), c(onSphere(random));
            const Spectrum f = RoughDiffuse(p).eval(l, c, Lobe::Smooth), g = Diffuse(same).eval(l, c, Lobe::Smooth);
            for (int k = 0; k < 3; ++k) REQUIRE(f[k] == Approx(g[k]).epsilon(1e-14));
        }
}

TEST_CASE("roughdiffuse: what it reflects") {
    for (const double alpha : {0.1, 0.47, 1.0})
        for (const double rho : {1.0, 0.3}) {
            const double v = alpha * alpha / 2, a = 1 - 0.5 * v / (v + 0.33), b = 0.45 * v / (v + 0.09);
            // Along the normal the grooves' azimuth does not matter.
            INFO("alpha " << alpha << ", reflectance " << rho);
            CHECK(reflectedPart(roughDiffuse(rho, alpha), 0) == Approx(rho * a + rho * rho * 0.17 * v / (v + 0.13)).epsilon(1e-7));
            for (const double theta : {0.0, 0.4, 1.0, 1.5}) {
                // ∫ max(0, cosφ) sin(max) tan(min) cosθ dω, with sin(max) tan(min) cosθ = sinθ_i sinθ below θ_i and
                // tanθ_i sinθ cosθ above.
                const double s = std::sin(theta);
                const double facing = 2 * (s * (theta / 2 - std::sin(2 * theta) / 4) + std::tan(theta) * (1 - s * s * s) / 3);
                INFO("angle " << theta);
                CHECK(reflectedPart(roughDiffuse(rho, alpha, true), theta) == Approx(rho * (a + b * facing / kPi)).epsilon(1e-7));
            }
        }
    // Light is thrown back to where it came from: more than by a Lambertian surface, and more than forwards.
    const RoughDiffuse moon = roughDiffuse(0.5, 0.7);
    CHECK(moon.eval(at(1.2), at(1.2), Lobe::Smooth).x > 1.2 * 0.5 / kPi);
    CHECK(moon.eval(at(1.2), at(1.2), Lobe::Smooth).x > 2 * moon.eval(at(1.2), at(-1.2), Lobe::Smooth).x);
}

TEST_CASE("roughdiffuse: the fit is cut where it falls below 0") {
    // cosφ = −1 at grazing angles; the interreflection, with another power of the reflectance, does not make up for it.
    const RoughDiffuse dark = roughDiffuse(0.1, 1);
    const Spectrum f = dark.eval(at(1.57), at(-1.57), Lobe::Smooth);
    CHECK(f.x >= 0);
    CHECK(f.z == 0);
}

TEST_CASE("phong: along the normal the lobe reflects k_s, elsewhere less") {
    for (const double n : {0.0, 1.0, 30.0, 2000.0}) {
        INFO("exponent " << n);
        const Phong bsdf = phong(0.3, 0.6, n);
        CHECK(reflectedPart(bsdf, 0) == Approx(0.9).epsilon(1e-7));
        CHECK(reflectedPart(bsdf, 1.2) < 0.9);
        const Vec3d l = at(0.7, 0.3), mirror(-l.x, -l.y, l.z);
        CHECK(bsdf.eval(l, mirror, Lobe::Smooth).x == Approx((0.3 + 0.6 * (n + 2) / 2) / kPi));
    }
    // Seen from the mirror direction: cos α = cosθ_l cosθ_c − sin sin cosφ.
    const double cosine = std::cos(0.7) * std::cos(0.2) - std::sin(0.7) * std::sin(0.2) * std::cos(2.0);
    CHECK(phong(0, 1, 8).eval(at(0.7), at(0.2, 2), Lobe::Smooth).x == Approx(10 / (2 * kPi) * std::pow(cosine, 8)));
}

TEST_CASE("phong: its density covers what stays above the surface") {
    for (const double n : {1.0, 10.0})
        for (const double theta : {0.1, 0.9}) {
            INFO("exponent " << n << ", angle " << theta);
            const Phong bsdf = phong(0, 1, n);
            const double all = overSphere([&](const Vec3d& to) { return bsdf.pdf(at(theta), to, Lobe::Smooth); });
            // In the lobe's own frame: z of a direction at α and ψ from the mirror direction.
            const double above = integral(
                [&](double alpha) {
                    // The part of the circle with cosα cosθ + sinα sinθ cosψ > 0.
                    const double bound = -std::cos(alpha) * std::cos(theta) / (std::sin(alpha) * std::sin(theta));
                    return std::acos(std::clamp(bound, -1.0, 1.0)) / kPi * (n + 1) * std::pow(std::cos(alpha), n) * std::sin(alpha);
                },
                0, kPi / 2);
            CHECK(all == Approx(above).margin(2e-4));
        }
}

TEST_CASE("ward: what its variants reflect along the normal") {
    for (const double alpha : {0.2, 0.5, 1.0}) {
        // Normals m of density D cosθ_m have tan²θ_m = α² x with x exponential; light leaves for x < 1/α². A sample carries
        // f cosθ / pdf.
        const auto mean = [&](auto&& weight) {
            return integral([&](double x) { return std::exp(-x) * weight(1 / (1 + alpha * alpha * x)); }, 0, 1 / (alpha * alpha));
        };
        const double a2 = alpha * alpha;
        INFO("alpha " << alpha);
        CHECK(reflectedPart(ward("balanced", 0, 1, alpha, alpha), 0) == Approx(1 - a2 * (1 - std::exp(-1 / a2))).epsilon(1e-6));
        CHECK(reflectedPart(ward("ward-duer", 0, 1, alpha, alpha), 0) == Approx(mean([](double z2) { return z2 * z2; })).epsilon(1e-6));
        CHECK(reflectedPart(ward("ward", 0, 1, alpha, alpha), 0) ==
              Approx(mean([](double z2) { return z2 * z2 * std::sqrt(2 * z2 - 1); })).epsilon(1e-6));
        CHECK(reflectedPart(ward("ward", 0.5, 0, alpha, alpha), 1) == Approx(0.5));
    }
}

TEST_CASE("ward: the variants at one pair of directions, anisotropic") {
    const Vec3d l = at(0.5), c = at(0.9, 2.5), h = l + c;
    const double gauss = std::exp(-(std::pow(h.x / 0.4, 2) + std::pow(h.y / 0.2, 2)) / (h.z * h.z)) / (kPi * 0.4 * 0.2);
    const auto value = [&](const char* variant) { return ward(variant, 0, 1, 0.4, 0.2).eval(l, c, Lobe::Smooth).x; };
    CHECK(value("ward") == Approx(gauss / (4 * std::sqrt(l.z * c.z))));
    CHECK(value("ward-duer") == Approx(gauss / (4 * l.z * c.z)));
    CHECK(value("balanced") == Approx(gauss * h.dot(h) / std::pow(h.z, 4)));
    CHECK(ward("ward", 0, 1, 0.4, 0.2).anisotropic());
    CHECK_FALSE(ward("ward", 0, 1, 0.4, 0.4).anisotropic());
}

TEST_CASE("ward-duer: its density is normalised where nothing is lost") {
    const Ward bsdf = ward("ward-duer", 0, 1, 0.1, 0.15);
    CHECK(overSphere([&](const Vec3d& to) { return bsdf.pdf(at(0.4, 1), to, Lobe::Smooth); }, 1600) == Approx(1).epsilon(1e-5));
}

TEST_CASE("gloss and base that reflect more than everything are refused") {
    CHECK_THROWS_AS(phong(0.7, 0.5, 10), Error);
    CHECK_THROWS_AS(ward("ward", 0.7, 0.5, 0.1, 0.1), Error);
}

TEST_CASE("principled: values that Mitsuba 3.9 gives") {
    const Vec3d a = Vec3d(0.5, 0.2, 0.8).normalized(), b = Vec3d(-0.3, 0.4, 0.6).normalized();
    const Vec3d grazing = Vec3d(0.9, 0.1, 0.15).normalized(), below = Vec3d(-0.4, -0.2, -0.7).normalized(), beside = Vec3d(0.1, 0.3, -0.9).normalized();
    const auto check = [](const Principled& bsdf, const Vec3d& toLight, const Vec3d& toCamera, const Spectrum& expected) {
        const Spectrum f = bsdf.eval(toLight, toCamera, Lobe::Smooth);
        INFO(expected.x << ", got " << f.x);
        for (int c = 0; c < 3; ++c) CHECK(f[c] == Approx(expected[c]).epsilon(2e-5));
    };
    const Principled plain(principledColour({0.8, 0.4, 0.1}, 0.5));
    check(plain, a, b, {0.26094, 0.133588, 0.0380735});
    check(plain, grazing, b, {0.251162, 0.128941, 0.0372746});
    check(plain, below, beside, {0, 0, 0});
    check(principledCloth(), a, b, {0.165874, 0.0844478, 0.0233785});
    check(principledCloth(), grazing, b, {0.192778, 0.0983552, 0.0275381});
    check(principledMetal(0.3), a, b, {0.0248712, 0.012436, 0.00310962});
    check(principledMetal(0.3), grazing, b, {0.0177681, 0.00895657, 0.0023479});
    const Principled glass = principledGlass(1.4, 0.7, 0.1, 0.6, 0.5);
    check(glass, a, b, {0.0782863, 0.0403063, 0.0118213});
    check(glass, a, below, {2.71032, 1.91649, 0.958244});
    check(glass, below, a, {1.38282, 0.977799, 0.4889});
    check(glass, below, beside, {0.0107118, 0.0107118, 0.0107118});
    check(principledBubble(), grazing, b, {0.180698, 0.114541, 0.0649241});
    check(principledBubble(), a, below, {2.07874, 1.46989, 0.734945});
    check(principledBubble(), below, beside, {0.00196462, 0.00196462, 0.00196462});
    auto dust = principledColour({0.8, 0.4, 0.1}, 1);
    dust.anisotropic = 1, dust.specular = 0, dust.flatness = 1, dust.sheen = 1;
    check(Principled(dust), a, b, {0.199239, 0.0996324, 0.0249278});
    check(Principled(dust), grazing, b, {0.303454, 0.154997, 0.0436537});
    auto nothing = principledColour({0.8, 0.4, 0.1}, 0.5);
    nothing.metallic = 1, nothing.specular = 0;
    check(Principled(nothing), a, b, {0, 0, 0});
}

TEST_CASE("principled: white glass is a rough dielectric") {
    auto p = principledColour(Spectrum(1.0), 0.5);
    p.eta = 1.6, p.specTrans = 1;
    const Principled principled(p);
    const RoughDielectric glass = roughDielectric(1.6, "ggx", 0.25, 0.25);
    Random random(makeKey(62), 0, 0);
    for (int i = 0; i < 2000; ++i) {
        const Vec3d l(onSphere(random)), c(onSphere(random));
        REQUIRE(principled.eval(l, c, Lobe::Smooth).x == Approx(glass.eval(l, c, Lobe::Smooth).x));
        REQUIRE(principled.pdf(l, c, Lobe::Smooth) == Approx(glass.pdf(l, c, Lobe::Smooth)));
    }
}

TEST_CASE("principled: specular is another word for eta, and refraction needs two media") {
    Principled::Parameters p;
    CHECK(p.ior() == Approx(1.5));
    p.specular = 0.02;
    CHECK(std::pow((p.ior() - 1) / (p.ior() + 1), 2) == Approx(0.08 * 0.02));
    p.specular = 0;
    CHECK(p.ior() == 1);
    p.specTrans = 0.5;
    CHECK(std::pow((p.ior() - 1) / (p.ior() + 1), 2) == Approx(0.08 * 0.001));
    p.specular = 0.5;
    p.eta = 1;
    CHECK(p.ior() == 1.001);
    CHECK(Principled(p).transmits);
    p.specTrans = 0;
    CHECK_FALSE(Principled(p).transmits);
}
