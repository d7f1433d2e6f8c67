// The emitter sunsky: the sun's position, reading, upgrading from Mitsuba 0.6 and exporting.

#include "core/base/file.h"
#include "core/scene/export/mitsuba.h"
#include "core/scene/mitsuba/upgrade.h"
#include "core/scene/sky/sun_position.h"
#include "tests/core/scene/load_text.h"

using namespace ulam;

namespace {

/// The map of a scene's only environment.
const EnvironmentMap& mapOf(const Scene& scene) {
    for (const Emitter& emitter : scene.emitters)
        if (const auto* sky = std::get_if<EnvmapEmitter>(&emitter)) return *sky->map;
    throw Error(ExitCode::InvalidConfig, "no environment");
}

std::string sunsky(const std::string& parameters) { return sceneWith(R"("sky": {"type": "sunsky")" + parameters + "}"); }

}  // namespace

TEST_CASE("the sun's position") {
    const SunPosition golden = sunPosition({39.742476, -105.1786, -7, 2003, 10, 17, 12, 30, 30});
    constexpr double kDegree = kPi / 180;
    CHECK(golden.zenith / kDegree == Approx(50.12795).margin(0.01));
    CHECK(golden.azimuth / kDegree == Approx(194.34024).margin(0.01));

    const auto mitsubaAgrees = [](const std::string& parameters, const Vec3f& expected) {
        const Scene scene = loadText(sunsky(parameters));
        CAPTURE(parameters);
        CHECK(length(mapOf(scene).sun()->direction() - expected) < 5e-4f);
    };
    mitsubaAgrees("", {0.0513854f, 0.691748f, 0.720308f});
    mitsubaAgrees(R"(, "hour": 10)", {0.174775f, -0.414812f, 0.892964f});
    mitsubaAgrees(R"(, "latitude": -33.9, "longitude": 18.4, "timezone": 2, "year": 2024, "month": 12, "day": 21,
                    "hour": 9, "minute": 30, "second": 15)", {-0.0083983f, -0.688063f, 0.725603f});
    mitsubaAgrees(R"(, "latitude": 51.5, "longitude": -0.1, "timezone": 0, "year": 1999, "month": 3, "day": 20, "hour": 12)",
                  {0.784587f, -0.0349197f, 0.619035f});
    mitsubaAgrees(R"(, "latitude": 64.1, "longitude": -21.9, "timezone": 0, "year": 2030, "month": 6, "day": 1, "hour": 22)",
                  {-0.684673f, 0.723662f, 0.0868128f});
}

TEST_CASE("a sun alone, a sky alone") {
    const Scene sun = loadText(sunsky(R"(, "sun_direction": [0, 3, 4], "sky_scale": 0, "sun_scale": 0.5)"));
    const EnvironmentMap& map = mapOf(sun);
    CHECK(isBlack(map.radiance({0, 0, 1})));
    CHECK(map.radiance({0, 0.6f, 0.8f}).y == Approx(18034.506 / 2).epsilon(3e-3));
    CHECK(map.pdf({0, 0, 1}) == 0);
    CHECK(map.pdf(map.sample(0.99999, 0.3)) == Approx(1 / map.sun()->solidAngle()));
    CHECK_FALSE(mapOf(loadText(sunsky(R"(, "sun_scale": 0)"))).sun());
}

TEST_CASE("sunsky: to_world turns the sky, sun_direction is in the world") {
    // +z is turned to +y.
    const Scene scene = loadText(sunsky(R"(, "sun_direction": [0.6, 0.8, 0], "sun_scale": 0,
        "to_world": [{"type": "rotate", "axis": [1, 0, 0], "angle": -90}, {"type": "scale", "value": [2, -2, 2]},
                     {"type": "scale", "value": [1, -1, 1]}])"));
    CHECK(mapOf(scene).radiance({0, 1, 0}).z == Approx(0.09558678).epsilon(1e-3));
    CHECK(isBlack(mapOf(scene).radiance({0, -1, 0})));
}

TEST_CASE("sunsky: mistakes") {
    CHECK(mentions(errorOf(sunsky(R"(, "sun_direction": [1, 0, -0.1])")), "degrees below the horizon"));
    CHECK(mentions(errorOf(sunsky(R"(, "sun_direction": [1, 0, -0.1])")), "/sky/sun_direction"));
    CHECK(mentions(errorOf(sunsky(R"(, "hour": 23)")), "below the horizon"));
    CHECK(mentions(errorOf(sunsky(R"(, "sun_direction": [1, 0, 1], "hour": 12)")), "/sky/hour"));
    CHECK(mentions(errorOf(sunsky(R"(, "sun_direction": [0, 0, 0])")), "longer than 0"));
    CHECK(mentions(errorOf(sunsky(R"(, "complex_sun": true)")), "/sky/complex_sun"));
    CHECK(mentions(errorOf(sunsky(R"(, "turbidity": 11)")), "/sky/turbidity"));
    CHECK(mentions(errorOf(sunsky(R"(, "albedo": [0, 0, 2])")), "/sky/albedo"));
    CHECK(mentions(errorOf(sunsky(R"(, "sky_scale": 0, "sun_scale": 0)")), "holds no light"));
    CHECK(mentions(errorOf(sunsky(R"(, "to_world": [{"type": "scale", "value": [1, 2, 1]}])")), "/sky/to_world"));
    CHECK(mentions(errorOf(sunsky(R"(, "turbidty": 2)")), "turbidity"));
}

TEST_CASE("sky, sun and sunsky of Mitsuba 0.6 become a sunsky") {
    const auto upgraded = [](Json plugin) {
        upgradePlugin(plugin, "emitter", {0, 6});
        return plugin;
    };
    const Json turn = {{"type", "matrix"}, {"value", {0, -1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1}}};
    CHECK(upgraded({{"type", "sky"}, {"scale", 3.0}, {"stretch", 1.0}, {"resolution", 256}}) ==
          Json{{"type", "sunsky"}, {"sky_scale", 3.0}, {"sun_scale", 0}, {"albedo", 0.2}, {"to_world", {turn}}});
    CHECK(upgraded({{"type", "sun"}, {"sun_radius_scale", 2.0}}) ==
          Json{{"type", "sunsky"}, {"sky_scale", 0}, {"sun_scale", 1}, {"albedo", 0.2}, {"sun_aperture", 1.0716}, {"to_world", {turn}}});
    const Json scale = {{"type", "scale"}, {"value", 2}};
    CHECK(upgraded({{"type", "sunsky"}, {"scale", 2.0}, {"sun_scale", 5.0}, {"albedo", 0.5}, {"to_world", {scale}}}) ==
          Json{{"type", "sunsky"}, {"sun_scale", 5.0}, {"albedo", 0.5}, {"to_world", {turn, scale}}, {"sky_scale", 2.0}});
    // Of other versions it is what it is there.
    Json newer = {{"type", "sunsky"}, {"sun_scale", 5.0}};
    upgradePlugin(newer, "emitter", {3, 0});
    CHECK(newer == Json{{"type", "sunsky"}, {"sun_scale", 5.0}});

    // The zenith was +y, east +x and south +z: at three in the afternoon in Tokyo the sun is in the west.
    Json old = upgraded({{"type", "sunsky"}});
    const Scene scene = loadText(sceneWith("\"sky\": " + old.dump()));
    const Vec3f sun = mapOf(scene).sun()->direction();
    CHECK(length(sun - Vec3f(-0.6917f, 0.7203f, 0.0514f)) < 5e-4f);
}

TEST_CASE("an exported sunsky has Mitsuba's types") {
    const SceneFolder files("sunsky_export");
    const std::string text = sunsky(R"(, "sun_direction": [0, 3, 4], "turbidity": 2, "albedo": [0.1, 0.2, 0.3])");
    CHECK(exportMitsuba3(describeText(text, files.path), files.path / "a").empty());
    const std::string xml = readFile(files.path / "a" / "scene.xml");
    CHECK(mentions(xml, R"(<emitter type="sunsky" id="sky">)"));
    CHECK(mentions(xml, R"(<vector name="sun_direction" value="0, 3, 4" />)"));
    CHECK(mentions(xml, R"(<float name="turbidity" value="2" />)"));
    CHECK(mentions(xml, R"(<rgb name="albedo" value="0.1, 0.2, 0.3" />)"));
    CHECK(exportMitsuba3(describeText(sunsky(R"(, "year": 2012, "hour": 12)"), files.path), files.path / "b").empty());
    const std::string dated = readFile(files.path / "b" / "scene.xml");
    CHECK(mentions(dated, R"(<integer name="year" value="2012" />)"));
    CHECK(mentions(dated, R"(<float name="hour" value="12" />)"));

    // Read back from Mitsuba 0.6's words it is the same sky.
    const std::string turned = R"(, "hour": 12, "albedo": 0.4, "sun_aperture": 1, "to_world": [{"type": "rotate", "axis": [1, 2, 3], "angle": 40}])";
    const auto before = describeText(sunsky(turned), files.path);
    CHECK(exportMitsuba06(before, files.path / "c").size() == 1);
    const auto after = SceneDescription::fromFile(files.path / "c" / "scene.xml");
    const Scene a = before.build(), b = after.build();
    CHECK(length(mapOf(a).sun()->direction() - mapOf(b).sun()->direction()) < 1e-6f);
    CHECK(mapOf(a).totalLuminance() == Approx(mapOf(b).totalLuminance()).epsilon(1e-6));
    CHECK(mapOf(a).sun()->radius() == Approx(mapOf(b).sun()->radius()));
    for (const Vec3f& w : {Vec3f(0, 0, 1), Vec3f(0.6f, 0, 0.8f), Vec3f(0, 1, 0)})
        CHECK(luminance(mapOf(a).radiance(w)) == Approx(luminance(mapOf(b).radiance(w))).epsilon(1e-4));
}
