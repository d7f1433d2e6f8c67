// Warps and the discrete distribution against their densities and inverses.

#include "core/base/warp.h"

#include "core/base/discrete.h"
#include "tests/support/catch.h"
#include "tests/support/chi_square.h"

using namespace ulam;

TEST_CASE("warps follow their densities") {
    // A disc in (azimuth, r²): uniform there too.
    CHECK_FIT(misfit(
        {-kPi, kPi, 0, 1, 32, 16},
        [](Random& r) {
            const double u = r(), v = r();
            const Vec2f p = squareToDisc(u, v);
            return Sample2{std::atan2(p.y, p.x), double(p.x) * p.x + double(p.y) * p.y};
        },
        [](double, double) { return 1 / (2 * kPi); }, 1));
    CHECK_FIT(misfit(
        kDirections,
        [](Random& r) {
            const double u = r(), v = r();
            return azimuthAndZ(squareToCosineHemisphere(u, v));
        },
        [](double, double z) { return cosineHemispherePdf(z); }, 2));
    CHECK_FIT(misfit(
        kDirections,
        [](Random& r) {
            const double u = r(), v = r();
            return azimuthAndZ(squareToSphere(u, v));
        },
        [](double, double) { return kSpherePdf; }, 3));
    // A triangle on a square grid whose diagonal cells it halves.
    CHECK_FIT(misfit(
        {0, 1, 0, 1, 20, 20},
        [](Random& r) {
            const double u = r(), v = r();
            const Vec2f b = squareToTriangle(u, v);
            return Sample2{b.x, b.y};
        },
        [](double x, double y) { return std::abs(x + y - 1) < 1e-9 ? 1
                                        : x + y < 1                ? 2
                                                                   : 0; }, 4));
    CHECK_FIT(misfit(
        {-9, 9, 0, 1, 180, 1},
        [](Random& r) {
            const double u = r(), v = r();
            return Sample2{squareToNormal(u, v), 0.5};
        },
        [](double x, double) { return std::exp(-x * x / 2) / std::sqrt(2 * kPi); }, 5));
}

TEST_CASE("warps and their inverses") {
    Random random(makeKey(6), 0, 0);
    const auto sameNumbers = [](const Sample2& s, double u, double v) {
        // Azimuths are on a circle; positions are floats, and a radius is the root of its number.
        const double turn = std::abs(s.v - v);
        return std::abs(s.u - u) < 2e-6 && std::min(turn, 1 - turn) * std::sqrt(u) < 1e-6;
    };
    for (int i = 0; i < 100'000; ++i) {
        const double u = random(), v = random();
        INFO(u << " " << v);
        const Vec2f disc = squareToDisc(u, v);
        REQUIRE(sameNumbers(discToSquare(disc.x, disc.y), u, v));
        REQUIRE(sameNumbers(cosineHemisphereToSquare(squareToCosineHemisphere(u, v)), u, v));
        // Relative precision of z at the horizon.
        const double low = u * 1e-5;
        const Sample2 horizon = cosineHemisphereToSquare(squareToCosineHemisphere(1 - low, v));
        REQUIRE(1 - horizon.u == Approx(low).epsilon(1e-4));
        // … and of the distance from the poles.
        REQUIRE(sphereToSquare(squareToSphere(low, v)).u == Approx(low).epsilon(1e-4));
        const Sample2 sphere = sphereToSquare(squareToSphere(u, v));
        REQUIRE(sameNumbers(sphere, u, v));
        REQUIRE(sphere.u == Approx(u).margin(1e-7));
        const Vec2f b = squareToTriangle(u, v);
        const Sample2 triangle = triangleToSquare(b);
        REQUIRE(triangle.u == Approx(u).margin(1e-6));
        REQUIRE(triangle.v * std::sqrt(u) == Approx(v * std::sqrt(u)).margin(1e-6));
    }
}

TEST_CASE("a frame is orthonormal around any normal") {
    Random random(makeKey(7), 0, 0);
    for (int i = 0; i < 100'000; ++i) {
        const double u = i < 10 ? i % 2 : random(), v = random();  // the poles too
        const Frame f(squareToSphere(u, v));
        REQUIRE(std::abs(dot(f.s, f.t)) < 1e-6f);
        REQUIRE(std::abs(dot(f.s, f.n)) < 1e-6f);
        REQUIRE(std::abs(length(f.s) - 1) < 1e-6f);
        REQUIRE(std::abs(length(f.t) - 1) < 1e-6f);
        REQUIRE(length(cross(f.s, f.t) - f.n) < 2e-6f);
        const Vec3f w = squareToSphere(random(), random());
        REQUIRE(length(f.toWorld(f.toLocal(w)) - w) < 2e-6f);
    }
}

TEST_CASE("a discrete distribution chooses by weight and hands back a uniform number") {
    const std::vector<double> weights = {3, 0, 1, 5, 0.5, 0, 0.5};
    const DiscreteDistribution distribution(weights);
    CHECK(distribution.total() == Approx(10));
    for (size_t i = 0; i < weights.size(); ++i) CHECK(distribution.probability(i) == Approx(weights[i] / 10));
    CHECK_FIT(misfit(
        {0, 7, 0, 1, 7, 10},
        [&](Random& r) {
            double u = r();
            const auto i = double(distribution.sample(u));
            return Sample2{i + 0.5, u};
        },
        [&](double x, double) { return weights[size_t(x)] / 10; }, 8));
    Random random(makeKey(9), 0, 0);
    for (int n = 0; n < 100'000; ++n) {
        const double u = random();
        double left = u;
        const size_t i = distribution.sample(left);
        REQUIRE(weights[i] > 0);
        REQUIRE((left >= 0 && left < 1));
        REQUIRE(distribution.invert(i, left) == Approx(u).epsilon(1e-12));
    }
    // The ends of the unit interval.
    for (double u : {0.0, 0x1p-60, 1 - 0x1p-53}) {
        const size_t i = distribution.sample(u);
        CHECK(weights[i] > 0);
    }
}

TEST_CASE("random numbers are uniform in pairs, and keys and counters do not share them") {
    CHECK_FIT(misfit(
        {0, 1, 0, 1, 30, 30},
        [](Random& r) {
            const double u = r(), v = r();
            return Sample2{u, v};
        },
        [](double, double) { return 1; }, 10));
    // Consecutive steps of a chain, and neighbouring chains.
    uint64_t step = 0;
    CHECK_FIT(misfit(
        {0, 1, 0, 1, 30, 30},
        [&](Random&) {
            ++step;
            return Sample2{Random({1, 2}, 3, step)(), Random({1, 2}, 3, step + 1)()};
        },
        [](double, double) { return 1; }, 0));
    CHECK_FIT(misfit(
        {0, 1, 0, 1, 30, 30},
        [&](Random&) {
            ++step;
            return Sample2{Random({1, 2}, uint32_t(step), 5)(), Random({1, 2}, uint32_t(step + 1), 5)()};
        },
        [](double, double) { return 1; }, 0));
    CHECK_FIT(misfit(
        {0, 1, 0, 1, 30, 30},
        [&](Random&) {
            ++step;
            return Sample2{Random(makeKey(step), 0, 0)(), Random(makeKey(step, 1), 0, 0)()};
        },
        [](double, double) { return 1; }, 0));
}
