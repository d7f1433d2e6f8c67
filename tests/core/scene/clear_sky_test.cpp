// Clear skies and their sun: the models against Mitsuba 3.9 (scalar_rgb), the picture of the sky against its model, and the
// sampling of sun and sky.

#include "core/scene/sky/clear_sky.h"
#include "core/scene/sky/hosek_wilkie.h"
#include "tests/support/chi_square.h"

using namespace ulam;

namespace {

constexpr double kDegree = kPi / 180;

/// With the zenith at +z and azimuths from +y towards +x.
Vec3d directionAt(double elevation, double azimuth) {
    const double e = elevation * kDegree, a = azimuth * kDegree;
    return {std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e)};
}

void near(const Spectrum& found, const Spectrum& expected, double tolerance) {
    for (int c = 0; c < 3; ++c) CHECK(found[c] == Approx(std::max(0.0, expected[c])).epsilon(tolerance));
}

ClearSky skyAt(double elevation, double turbidity = 3) {
    ClearSky sky;
    sky.sun = Vec3f(directionAt(elevation, 0));
    sky.turbidity = turbidity;
    return sky;
}

}  // namespace

TEST_CASE("the sky's radiance is that of Mitsuba 3.9") {
    struct Case {
        double turbidity;
        Spectrum albedo;
        double sunElevation, elevation, azimuth;
        Spectrum radiance;
    };
    const Case cases[] = {
        {1, {0, 0, 0}, 0.5, 90, 0, {0.004281487, 0.005360113, 0.005591621}},
        {1, {0, 0, 0}, 0.5, 40, 70, {0.01019935, 0.01153498, 0.01052624}},
        {1, {0, 0, 0}, 0.5, 1, 180, {0.05734739, 0.02404144, 0.003427732}},
        {1, {0, 0, 0}, 0.5, 0.5, 3, {0.08124043, 0.04765219, 0.01212917}},
        {2.25, {1, 0.5, 0}, 5, 90, 0, {0.007382972, 0.01242944, 0.01747211}},
        {2.25, {1, 0.5, 0}, 5, 40, 70, {0.01765123, 0.02503221, 0.03122027}},
        {2.25, {1, 0.5, 0}, 5, 1, 180, {0.1228419, 0.09660707, 0.03989605}},
        {2.25, {1, 0.5, 0}, 5, 5, 3, {0.3492103, 0.2295469, 0.08634163}},
        {3, {0.3, 0.3, 0.3}, 30, 90, 0, {0.01646589, 0.03133863, 0.06254063}},
        {3, {0.3, 0.3, 0.3}, 30, 40, 70, {0.03243179, 0.0562104, 0.09770725}},
        {3, {0.3, 0.3, 0.3}, 30, 1, 180, {0.1709327, 0.2176102, 0.2149514}},
        {3, {0.3, 0.3, 0.3}, 30, 30, 3, {0.2334273, 0.2520244, 0.2530478}},
        {6.5, {0.7, 0.2, 0.4}, 12, 90, 0, {0.01601523, 0.02309705, 0.03642999}},
        {6.5, {0.7, 0.2, 0.4}, 12, 40, 70, {0.03563365, 0.04386145, 0.0585078}},
        {6.5, {0.7, 0.2, 0.4}, 12, 1, 180, {0.0985532, 0.0794019, 0.07024475}},
        {6.5, {0.7, 0.2, 0.4}, 12, 12, 3, {1.190534, 0.8712583, 0.4357942}},
        {10, {1, 1, 1}, 80, 90, 0, {0.9157003, 0.8668637, 0.7832501}},
        {10, {1, 1, 1}, 80, 40, 70, {0.1935352, 0.2139087, 0.2553394}},
        {10, {1, 1, 1}, 80, 1, 180, {0.3536527, 0.3018037, 0.2849787}},
        {10, {1, 1, 1}, 80, 80, 3, {1.262176, 1.201451, 1.074168}},
    };
    for (const Case& c : cases) {
        CAPTURE(c.turbidity, c.sunElevation, c.elevation, c.azimuth);
        const Vec3d w = directionAt(c.elevation, c.azimuth);
        const double gamma = std::acos(std::min(1.0, w.dot(directionAt(c.sunElevation, 0))));
        near(SkyModel(c.turbidity, c.albedo, c.sunElevation * kDegree).radiance(w.z, gamma), c.radiance, 5e-5);
    }
}

TEST_CASE("the sun's radiance is that of Mitsuba 3.9, whatever its size") {
    struct Case {
        double turbidity, elevation, aperture;
        Spectrum radiance;
    };
    const Case cases[] = {
        {1, 0.5, 0.5358, {7058.031, 2011.485, -110.377}},     {2.5, 3, 0.5358, {6554.524, 2401.081, 158.4093}},
        {3, 30, 0.5358, {20274.44, 15949.58, 10618.1}},       {3, 30, 2, {1452.142, 1142.377, 760.5135}},
        {6.5, 45, 0.5358, {18855.24, 15282.36, 11334.56}},    {10, 90, 0.5358, {14974.92, 12163.4, 9842.132}},
        {4, 87, 10, {61.97123, 52.33747, 41.44484}},
    };
    for (const Case& c : cases) {
        CAPTURE(c.turbidity, c.elevation, c.aperture);
        ClearSky sky = skyAt(c.elevation, c.turbidity);
        sky.sunRadius = c.aperture / 2 * kDegree;
        near(sky.map().sun()->radiance(), c.radiance, 3e-3);
    }
}

TEST_CASE("the picture of the sky is its model, and ends at the horizon") {
    for (const auto& [turbidity, elevation] : {std::pair(1.0, 1.0), {3.0, 30.0}, {3.0, 88.0}, {10.0, 10.0}}) {
        CAPTURE(turbidity, elevation);
        ClearSky sky = skyAt(elevation, turbidity);
        sky.sunScale = 0;
        sky.skyScale = 2;
        const EnvironmentMap map = sky.map();
        const SkyModel model(turbidity, sky.albedo, elevation * kDegree);
        const Vec3d sun = directionAt(elevation, 0);
        // Irradiances of a floor and of walls that face the sun, its side and its back: midpoints in azimuth and √cosθ.
        constexpr int kRows = 300, kColumns = 360;
        std::array<double, 4> found{}, expected{};
        for (int i = 0; i < kRows; ++i)
            for (int j = 0; j < kColumns; ++j) {
                const double t = (i + 0.5) / kRows, z = t * t, r = std::sqrt(1 - z * z), phi = 2 * kPi * (j + 0.3) / kColumns;
                const Vec3d w(r * std::cos(phi), r * std::sin(phi), z);
                const double picture = luminance(map.radiance(Vec3f(w)));
                const double exact = 2 * luminance(model.radiance(z, std::acos(std::clamp(w.dot(sun), -1.0, 1.0))));
                const double cosines[] = {w.z, std::max(0.0, w.y), std::max(0.0, w.x), std::max(0.0, -w.y)};
                for (size_t k = 0; k < 4; ++k) found[k] += t * cosines[k] * picture, expected[k] += t * cosines[k] * exact;
            }
        for (size_t k = 0; k < 4; ++k) CHECK(found[k] == Approx(expected[k]).epsilon(1e-4));
        for (double azimuth = 0; azimuth < 360; azimuth += 7) {
            const double exact = 2 * model.radiance(0, std::acos(directionAt(0, azimuth).dot(sun))).x;
            CHECK(map.radiance(Vec3f(directionAt(0, azimuth))).x == Approx(exact).epsilon(2e-3));
            for (const double below : {-1e-4, -5.0, -90.0}) {
                const Vec3f w(directionAt(below, azimuth));
                REQUIRE(isBlack(map.radiance(w)));
                REQUIRE(map.pdf(w) == 0);
            }
        }
    }
}

TEST_CASE("the sun's disc: all samples are inside, uniform, and found again") {
    for (const double radius : {SunDisc::kSmallestRadius, 0.2679 * kDegree, 0.3}) {
        for (const Vec3f& axis : {Vec3f(0, 0, 1), normalize(Vec3f(0.3f, -0.8f, 0.4f)), Vec3f(-1, 0, 0)}) {
            CAPTURE(radius, axis.x);
            const SunDisc disc(axis, radius, Spectrum(1));
            CHECK(disc.solidAngle() == Approx(2 * kPi * (1 - std::cos(radius))).epsilon(1e-5));
            Random random(makeKey(60), 0, 0);
            const double margin = 3e-7 / radius;  // some steps of a float, over the radius
            for (int i = 0; i < 50'000; ++i) {
                const double u = i % 2 ? random() : 1 - 1e-9 * random(), v = random();
                const Vec3f w = disc.sample(u, v);
                REQUIRE(disc.holds(w));
                const Sample2 again = disc.invert(w);
                REQUIRE((again.u >= 0 && again.u < 1 && again.v >= 0 && again.v < 1));
                REQUIRE(std::abs(again.u - u) < 2 * margin);
                REQUIRE(length(disc.sample(again.u, again.v) - w) < 5e-7f);
            }
            CHECK(disc.holds(axis));
            CHECK_FALSE(disc.holds(-axis));
            const Frame frame(axis);
            for (const double f : {0.99, 1.01}) {
                const float a = float(f * radius);
                CHECK(disc.holds(frame.toWorld({std::sin(a), 0, std::cos(a)})) == (f < 1));
            }
        }
    }
}

TEST_CASE("sun and sky: directions follow their density, whose integral is 1") {
    SECTION("a sky without the sun") {
        ClearSky sky = skyAt(25);
        sky.sunScale = 0;
        const EnvironmentMap map = sky.map();
        CHECK_FIT(misfit(
            kDirections, [&](Random& r) { const double u = r(); return azimuthAndZ(map.sample(u, r())); },
            [&](double phi, double z) { return map.pdf(directionOf(phi, z)); }, 61));
    }
    SECTION("a wide sun in a picture") {
        Image picture(6, 4);
        Random random(makeKey(62), 0, 0);
        for (Rgb& pixel : picture.pixels) pixel = Rgb(float(random()), float(random()), 0.5f);
        const Frame frame(normalize(Vec3f(1, 0.2f, -0.3f)));
        // Its rim at z = 0.9, a border of the cells.
        const SunDisc sun({0, 0, 1}, std::acos(0.9), Spectrum(8));
        const EnvironmentMap map(picture, 1, {frame.s, frame.t, frame.n}, EnvironmentMap::Extent::Sphere, sun);
        CHECK_FIT(misfit(
            kDirections, [&](Random& r) { const double u = r(); return azimuthAndZ(map.sample(u, r())); },
            [&](double phi, double z) { return map.pdf(directionOf(phi, z)); }, 63));
    }
}

TEST_CASE("sun and sky: samples carry the light, and their numbers are found again") {
    for (const double elevation : {0.1, 35.0}) {
        CAPTURE(elevation);
        ClearSky sky = skyAt(elevation);
        sky.zenith = normalize(Vec3f(0.2f, -0.1f, 1));
        sky.sun = normalize(sky.sun + (sky.zenith - Vec3f(0, 0, 1)));
        if (elevation < 1) sky.sun = normalize(sky.sun - sky.zenith * (dot(sky.sun, sky.zenith) - 0.002f));
        const EnvironmentMap map = sky.map();
        Random random(makeKey(64), 0, 0);
        double integral = 0, fromSun = 0;
        constexpr int kSamples = 200'000;
        for (int i = 0; i < kSamples; ++i) {
            const double u = random(), v = random();
            const Vec3f w = map.sample(u, v);
            const double pdf = map.pdf(w);
            REQUIRE(pdf > 0);
            integral += luminance(map.radiance(w)) / pdf / kSamples;
            if (map.sun()->holds(w)) fromSun += 1.0 / kSamples;
            const Sample2 again = map.invert(w, random());
            REQUIRE((again.u >= 0 && again.u <= 1 && again.v >= 0 && again.v <= 1));
            REQUIRE(length(map.sample(again.u, again.v) - w) < 1e-5f);
        }
        CHECK(map.totalLuminance() == Approx(integral).epsilon(0.003));
        CHECK((fromSun > 0.1 && fromSun < 1));
        // The numbers that a direction gives back are as uniform as those it came from.
        const auto inverse = [&](Random& r) {
            const double u = r(), v = r();
            const Sample2 s = map.invert(map.sample(u, v), r());
            return s;
        };
        CHECK_FIT(misfit({0, 1, 0, 1, 30, 30}, inverse, [](double, double) { return 1.0; }, 65, 300'000));
    }
}
