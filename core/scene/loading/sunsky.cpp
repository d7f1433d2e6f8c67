#include "core/scene/loading/sunsky.h"

#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"
#include "core/scene/sky/clear_sky.h"
#include "core/scene/sky/sun_position.h"

namespace ulam {
namespace {

constexpr double kRadian = kPi / 180;

struct SunskyParameters {
    double turbidity = 3, sunScale = 1, skyScale = 1, sunAperture = 0.5358;
    Spectrum albedo{0.3, 0.3, 0.3};
    bool complexSun = false;
    PlaceAndTime when;
    JsonNode sunDirection, toWorld;

    template <class V>
    void describe(V& v) {
        v("turbidity", turbidity, {.help = "haze: 2 is arctic air, 3 a clear sky in a temperate climate, 10 a humid day", .min = 1, .max = 10});
        v("albedo", albedo, {.help = "of the ground, which lights the sky from below", .min = 0, .max = 1});
        v("sun_direction", sunDirection,
          {.help = "to the sun, in the world [x,y,z]; instead of place and time", .example = "[0.3, 0.5, 0.8]"});
        v("latitude", when.latitude, {.help = "north of the equator", .unit = "degrees", .min = -90, .max = 90});
        v("longitude", when.longitude, {.help = "east of Greenwich", .unit = "degrees", .min = -360, .max = 360});
        v("timezone", when.timezone, {.help = "ahead of Greenwich", .unit = "hours", .min = -24, .max = 24});
        v("year", when.year, {.help = "of the Gregorian calendar", .min = 1900, .max = 2100});
        v("month", when.month, {.help = "1 is January", .min = 1, .max = 12});
        v("day", when.day, {.help = "of the month", .min = 1, .max = 31});
        v("hour", when.hour, {.help = "of local time, without daylight saving", .min = 0, .max = 24});
        v("minute", when.minute, {.help = "of the hour", .min = 0, .max = 60});
        v("second", when.second, {.help = "of the minute", .min = 0, .max = 60});
        v("sky_scale", skyScale, {.help = "factor on the sky's radiance; 0: none", .min = 0});
        v("sun_scale", sunScale, {.help = "factor on the sun's radiance; 0: none", .min = 0});
        v("sun_aperture", sunAperture, {.help = "the angle under which the sun is seen; does not change its power", .unit = "degrees", .min = 0.01, .max = 90});
        v("complex_sun", complexSun, {.help = "darker towards its rim; not supported"});
        v("to_world", toWorld,
          {.help = "turns the sky; its zenith is +z, south is +x, west is +y",
           .example = R"([{"type": "rotate", "axis": [1, 0, 0], "angle": -90}])"});
    }
};

/// The sun's direction before to_world, as Mitsuba 3 turns azimuths into x and y.
Vec3d localSun(const PlaceAndTime& when) {
    const SunPosition sun = sunPosition(when);
    return {-std::sin(sun.zenith) * std::cos(sun.azimuth), -std::sin(sun.zenith) * std::sin(sun.azimuth), std::cos(sun.zenith)};
}

Vec3f sunDirection(const JsonNode& node, const SunskyParameters& p, const std::array<Vec3f, 3>& axes) {
    if (p.sunDirection.isNull()) {
        const Vec3f w(localSun(p.when));
        return normalize(axes[0] * w.x + axes[1] * w.y + axes[2] * w.z);
    }
    for (const char* name : {"latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"})
        if (const auto given = node.find(name)) given->fail(fmt::format("a sunsky has either a sun_direction or place and time ({})", name));
    const Vec3d direction = parseVector(p.sunDirection);
    if (!(direction.length() > 0)) p.sunDirection.expected("a direction longer than 0");
    return Vec3f(direction.normalized());
}

}  // namespace

std::vector<ParameterInfo> sunskyParameters() {
    return parameterInfo<SunskyParameters>();
}

Emitter readSunsky(const JsonNode& node, LoadContext&) {
    const auto p = parsePlugin<SunskyParameters>(node);
    if (p.complexSun) node.at("complex_sun").fail("a sun with a darker rim is not supported; its mean radiance, complex_sun = false, is");
    const Matrix4 m = parseTransform(p.toWorld);
    if (!uniformScale(m)) p.toWorld.fail("a sunsky's to_world must keep angles: rotations and mirrorings only");
    const std::array<Vec3f, 3> axes = axesOf(m);
    ClearSky sky;
    sky.turbidity = p.turbidity;
    sky.albedo = p.albedo;
    sky.zenith = axes[2];
    sky.sun = sunDirection(node, p, axes);
    sky.sunRadius = p.sunAperture / 2 * kRadian;
    sky.skyScale = p.skyScale;
    sky.sunScale = p.sunScale;
    const double sine = double(dot(sky.sun, sky.zenith));
    if (sine < 0)
        (p.sunDirection.isNull() ? node : p.sunDirection)
            .fail(fmt::format("the sun is {:.3g} degrees below the horizon: there is no light", -std::asin(std::max(-1.0, sine)) / kRadian),
                  "the zenith of a sunsky is +z, turned by its to_world");
    auto map = std::make_shared<const EnvironmentMap>(sky.map());
    if (!(map->totalLuminance() > 0)) node.fail("the sunsky holds no light: sun_scale and sky_scale are 0");
    return EnvmapEmitter{std::move(map)};
}

}  // namespace ulam
