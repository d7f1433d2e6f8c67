// Microfacet distributions: definitions, samples against densities, inverses.

#include "core/scene/bsdfs/microfacet.h"

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <fmt/format.h>

#include "tests/support/chi_square.h"
#include "tests/support/dual.h"

using namespace ulam;

namespace {

using Kind = MicrofacetDistribution::Kind;

const std::vector<MicrofacetDistribution>& distributions() {
    static const std::vector<MicrofacetDistribution> all = [] {
        std::vector<MicrofacetDistribution> made;
        for (const Kind kind : {Kind::Beckmann, Kind::Ggx})
            for (const auto& [u, v] : {std::pair(1e-4, 1e-4), {0.01, 0.01}, {0.1, 0.1}, {0.5, 0.5}, {1.0, 1.0}, {0.05, 0.4}, {0.9, 0.02}})
                made.emplace_back(kind, u, v);
        return made;
    }();
    return all;
}

std::string nameOf(const MicrofacetDistribution& d) {
    return fmt::format("{} {} {}", d.kind == Kind::Ggx ? "ggx" : "beckmann", d.alphaU, d.alphaV);
}

Vec3d towards(double azimuth, double z) {
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(azimuth), r * std::sin(azimuth), z};
}

/// Normals by azimuth and angle v of their slope in units of alpha, tan v: the whole hemisphere, at every roughness.
constexpr Domain kSlopes{-kPi, kPi, 0, kPi / 2, 40, 20};
Sample2 slopeOf(const MicrofacetDistribution& d, const Vec3d& m) {
    const double x = m.x / (m.z * d.alphaU), y = m.y / (m.z * d.alphaV);
    return {std::atan2(y, x), std::atan(std::hypot(x, y))};
}
/// The normal there, and dω / (dφ dv).
std::pair<Vec3d, double> normalAt(const MicrofacetDistribution& d, double phi, double v) {
    const double r = std::tan(std::min(v, kPi / 2 - 1e-9));
    const Vec3d n(d.alphaU * r * std::cos(phi), d.alphaV * r * std::sin(phi), 1);
    return {n.normalized(), d.alphaU * d.alphaV * r * (1 + r * r) / std::pow(n.length(), 3)};
}

/// ∫ g(m) dω over all normals.
template <class Function>
double overNormals(const MicrofacetDistribution& d, Function&& g) {
    using boost::math::quadrature::gauss_kronrod;
    return gauss_kronrod<double, 31>::integrate(
        [&](double phi) {
            return gauss_kronrod<double, 31>::integrate(
                [&](double v) {
                    const auto [m, jacobian] = normalAt(d, phi, v);
                    return g(m) * jacobian;
                },
                0, kPi / 2, 8, 1e-9);
        },
        -kPi, kPi, 6, 1e-7);
}

}  // namespace

TEST_CASE("microfacets have the area of the surface when seen from above, and what is seen of them is all that faces") {
    for (const MicrofacetDistribution& d : distributions()) {
        INFO(nameOf(d));
        CHECK(overNormals(d, [&](const Vec3d& m) { return m.z * d.density(m); }) == Approx(1).epsilon(1e-6));
        for (const double z : {1.0, 0.8, 0.3, 0.02, 1e-4}) {
            // ∫ G1(w) (w·m)+ D(m) dm = cosθ (Heitz 2014, eq. 14).
            const Vec3d w = towards(0.7, z);
            const double facing = overNormals(d, [&](const Vec3d& m) { return std::max(0.0, w.dot(m)) * d.density(m); });
            INFO("cosine " << z);
            CHECK(d.projectedArea(w) == Approx(facing).epsilon(1e-5));
        }
    }
}

TEST_CASE("microfacets: known values") {
    for (const MicrofacetDistribution& d : distributions()) {
        INFO(nameOf(d));
        CHECK(d.density(Vec3d(0, 0, 1)) == Approx(1 / (kPi * d.alphaU * d.alphaV)));
        CHECK(d.projectedArea(Vec3d(0, 0, 1)) == Approx(1).epsilon(1e-12));
        CHECK(d.density(Vec3d(0.6, 0, -0.8)) == 0);
        // A profile of slopes: alpha along x at azimuth 0 and along y at 90°. Walter et al. 2007, eq. 25, 27, 33, 34.
        for (const bool alongY : {false, true})
            for (const double tangent : {0.3, 1.0, 2.5}) {
                const double alpha = alongY ? d.alphaV : d.alphaU, t = tangent * alpha, z = 1 / std::hypot(1, t);
                const Vec3d m = towards(alongY ? kPi / 2 : 0, z);
                const double a2 = d.alphaU * d.alphaV, c4 = std::pow(z, 4);
                if (d.kind == Kind::Ggx) {
                    CHECK(d.density(m) == Approx(1 / (kPi * a2 * c4 * std::pow(1 + tangent * tangent, 2))));
                    const Vec3d w = towards(alongY ? kPi / 2 : 0, 1 / std::hypot(1, tangent / alpha));
                    CHECK(w.z / d.projectedArea(w) == Approx(2 / (1 + std::sqrt(1 + tangent * tangent))));
                } else {
                    CHECK(d.density(m) == Approx(std::exp(-tangent * tangent) / (kPi * a2 * c4)));
                    const Vec3d w = towards(alongY ? kPi / 2 : 0, 1 / std::hypot(1, tangent / alpha));
                    const double a = 1 / tangent;
                    CHECK(w.z / d.projectedArea(w) ==
                          Approx(2 / (1 + std::erf(a) + std::exp(-a * a) / (a * std::sqrt(kPi)))));
                }
            }
    }
    const MicrofacetDistribution clamped(Kind::Ggx, 0, 7);
    CHECK(clamped.alphaU == 1e-4);
    CHECK(clamped.alphaV == 1);
}

TEST_CASE("visible normals follow their density") {
    uint64_t seed = 1;
    for (const MicrofacetDistribution& d : distributions())
        for (const double z : {1.0, 0.4, 0.01}) {
            if (d.alphaU == 1e-4 && z == 0.4) continue;
            INFO(nameOf(d) << ", cosine " << z << ", seed " << seed);
            const Vec3d w = towards(-2.1, z);
            CHECK_FIT(misfit(
                kSlopes,
                [&](Random& r) {
                    const Block u = r.nextBlock();
                    return std::optional(slopeOf(d, d.sampleVisible(w, u[0], u[1])));
                },
                [&](double phi, double v) {
                    const auto [m, jacobian] = normalAt(d, phi, v);
                    return d.visible(w, m) * jacobian;
                },
                seed++, 200'000));
        }
}

TEST_CASE("the numbers of a visible normal give it again, and the normal its numbers") {
    Random random(makeKey(30), 0, 0);
    for (const MicrofacetDistribution& d : distributions())
        for (const double z : {1.0, 0.999, 0.4, 0.01, 1e-5})
            for (int i = 0; i < 500; ++i) {
                const Vec3d w = towards(i, z);
                const Block u = random.nextBlock();
                const Vec3d m = d.sampleVisible(w, u[0], u[1]);
                INFO(nameOf(d) << ", cosine " << z << ", numbers " << u[0] << ' ' << u[1]);
                REQUIRE(m.length() == Approx(1).epsilon(1e-12));
                REQUIRE(m.z > 0);
                REQUIRE(w.dot(m) > -1e-9);
                const Sample2 s = d.invertVisible(w, m);
                REQUIRE(s.u == Approx(u[0]).margin(1e-7));
                REQUIRE(s.v == Approx(u[1]).margin(1e-7));
                REQUIRE((d.sampleVisible(w, s.u, s.v) - m).length() < 1e-7);
            }
}

TEST_CASE("normals are found for the extreme numbers too") {
    for (const MicrofacetDistribution& d : distributions())
        for (const double z : {1.0, 0.3, 1e-6, 0.0})
            for (const double u : {0.0, 0x1p-33, 0.5, 1 - 0x1p-33})
                for (const double v : {0.0, 0x1p-33, 0.5, 1 - 0x1p-33}) {
                    const Vec3d m = d.sampleVisible(towards(1, z), u, v);
                    INFO(nameOf(d) << ", cosine " << z << ", numbers " << u << ' ' << v);
                    CHECK(m.length() == Approx(1).epsilon(1e-9));
                    CHECK(m.z > 0);
                }
}

TEST_CASE("dual numbers give the derivatives of microfacet distributions") {
    Random random(makeKey(31), 0, 0);
    for (const MicrofacetDistribution& d : distributions()) {
        if (d.alphaU < 0.01) continue;
        for (int i = 0; i < 50; ++i) {
            const Block u = random.nextBlock();
            const Vec3d w = towards(6 * u[0], 0.05 + 0.95 * u[1]), m = d.sampleVisible(w, u[2], u[3]);
            const Block velocity = random.nextBlock();
            const auto values = [&](auto t) {
                using T = decltype(t);
                const auto moved = [&](const Vec3d& at, double x, double y) {
                    return Direction<T>(T(at.x) + t * T(x), T(at.y) + t * T(y), T(at.z) + t * T(0.5));
                };
                const auto movedW = moved(w, velocity[0], velocity[1]), movedM = moved(m, velocity[2], velocity[3]);
                return std::array{d.density(movedM), d.projectedArea(movedW), d.visible(movedW, movedM)};
            };
            const double h = 1e-8;
            const auto dual = values(Dual(0, 1));
            const auto plain = values(0.0), up = values(h), down = values(-h);
            for (size_t j = 0; j < dual.size(); ++j) {
                INFO(nameOf(d) << ", function " << j);
                REQUIRE(dual[j].v == plain[j]);
                REQUIRE(dual[j].d == Approx((up[j] - down[j]) / (2 * h)).epsilon(1e-4).margin(1e-5 * (1 + std::abs(plain[j] / d.alphaU))));
            }
        }
    }
}
