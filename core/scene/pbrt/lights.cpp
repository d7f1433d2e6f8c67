#include "core/scene/pbrt/lights.h"

#include <fmt/format.h>

#include <cmath>

#include "core/config/suggest.h"

namespace ulam::pbrt {
namespace {

constexpr double kDegree = kPi / 180;

Json point(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

Vec3d moved(const Matrix4& m, const Vec3d& v) {
    Vec3d out;
    m.multVecMatrix(v, out);
    return out;
}

/// Colour and scale; `unit` is the power that a scale of 1 gives.
Spectrum intensity(const Parameters& p, std::string_view colour, double unit, const Dictionary& dictionary) {
    const double scale = p.number("scale", 1), power = p.number("power", -1);
    return light(p, colour, dictionary) * (power > 0 ? scale * power / unit : scale);
}

Json readPoint(const Parameters& p, const Matrix4& toWorld, Dictionary& dictionary) {
    return {{"type", "point"},
            {"position", point(moved(toWorld, p.point("from", Vec3d(0.0))))},
            {"intensity", colourJson(intensity(p, "I", 4 * kPi, dictionary))}};
}

Json readSpot(const Parameters& p, const Matrix4& toWorld, Dictionary& dictionary) {
    const Vec3d from = p.point("from", Vec3d(0.0)), to = p.point("to", {0, 0, 1});
    const double cone = p.number("coneangle", 30), delta = p.number("conedeltaangle", 5), full = cone - delta;
    if (!(cone > 0 && cone <= 180 && delta >= 0 && full >= 0))
        refuse(
            p.place(),
            fmt::format("coneangle of {} is from 0 to 180 degrees, and conedeltaangle from 0 to coneangle", p.owner()));
    const double end = std::cos(cone * kDegree), start = std::cos(full * kDegree);
    const Spectrum colour = intensity(p, "I", 2 * kPi * ((1 - start) + (start - end) / 2), dictionary);
    if (delta > 0)
        dictionary.substitute(fmt::format(
            "the {} at {} fades linearly with the angle between its inner and outer cone, not smoothly with the cosine",
            p.owner(), p.place().text()));
    // 0 would stand for three quarters of the cone.
    return {{"type", "spot"},
            {"to_world",
             {{{"type", "lookat"}, {"origin", point(moved(toWorld, from))}, {"target", point(moved(toWorld, to))}}}},
            {"intensity", colourJson(colour)},
            {"cutoff_angle", cone},
            {"beam_width", std::max(full, 1e-6)}};
}

Json readDistant(const Parameters& p, const Matrix4& toWorld, Dictionary& dictionary) {
    const Vec3d travel = p.point("to", {0, 0, 1}) - p.point("from", Vec3d(0.0));
    Vec3d direction;
    toWorld.multDirMatrix(travel, direction);
    if (!(direction.length() > 0))
        refuse(p.place(), fmt::format("\"from\" and \"to\" of {} are the same point", p.owner()));
    const double scale = p.number("scale", 1), illuminance = p.number("illuminance", -1);
    return {{"type", "directional"},
            {"direction", point(direction)},
            {"irradiance", colourJson(light(p, "L", dictionary) * (illuminance > 0 ? scale * illuminance : scale))}};
}

Json readInfinite(const Parameters& p, const Matrix4& toWorld, Dictionary& dictionary) {
    const double scale = p.number("scale", 1), illuminance = p.number("illuminance", -1);
    if (const Parameter* portal = p.find("portal", {"point3"}))
        refuse(portal->place, fmt::format("\"portal\" of {} is not supported", p.owner()));
    const Parameter* filename = p.find("filename", {"string"});
    const Spectrum colour = light(p, "L", dictionary);
    if (!filename)
        return {{"type", "constant"},
                {"radiance", colourJson(colour * (illuminance > 0 ? scale * illuminance / kPi : scale))}};
    if (const Parameter* given = p.find("L", {"rgb", "spectrum", "blackbody"}))
        refuse(given->place, fmt::format("{} has either \"L\" or \"filename\"", p.owner()));
    if (illuminance > 0)
        refuse(p.find("illuminance", {"float"})->place,
               fmt::format("\"illuminance\" of {} with a picture is not supported", p.owner()), "give a scale");
    Json entry = {{"type", "envmap"}, {"filename", p.text("filename", "")}, {"mapping", "octahedral"}};
    if (scale != 1) entry["scale"] = scale;
    if (toWorld != Matrix4()) {
        Matrix4 turn = toWorld;
        for (int c = 0; c < 3; ++c) turn[3][c] = 0;
        entry["to_world"] = matrixJson(turn);
    }
    return entry;
}

}  // namespace

Json readLight(const std::string& type, const Parameters& p, const Matrix4& toWorld, Dictionary& dictionary) {
    Json entry;
    if (type == "point")
        entry = readPoint(p, toWorld, dictionary);
    else if (type == "spot")
        entry = readSpot(p, toWorld, dictionary);
    else if (type == "distant")
        entry = readDistant(p, toWorld, dictionary);
    else if (type == "infinite")
        entry = readInfinite(p, toWorld, dictionary);
    else {
        dictionary.unknown("light", type, {"distant", "infinite", "point", "spot"}, p.place(), "it is left out");
        return nullptr;
    }
    p.finish();
    return entry;
}

Json readAreaLight(const std::string& type, const Parameters& p, const ShapeRecord& shape, Dictionary& dictionary) {
    if (type != "diffuse") {
        dictionary.unknown("area light", type, {"diffuse"}, p.place(), "it is left out");
        return nullptr;
    }
    double unit = 1;
    if (p.number("power", -1) > 0) {
        const auto area = lightArea(shape);
        if (!area)
            refuse(p.place(),
                   fmt::format("\"power\" of {}: each triangle of a mesh gets all of it, and these have different "
                               "areas or are in a file",
                               p.owner()),
                   "give \"L\"");
        unit = kPi * *area;
    }
    const Spectrum radiance = intensity(p, "L", unit, dictionary);
    if (p.flag("twosided", false))
        dictionary.unsupported(fmt::format("\"twosided\" of {}", p.owner()), p.place(),
                               "lights shine from the side of their normals",
                               "it shines from the side of the normals only");
    if (const Parameter* filename = p.find("filename", {"string"}))
        dictionary.unsupported(fmt::format("\"filename\" of {}", p.owner()), filename->place, {}, "it shines evenly");
    p.finish();
    return {{"type", "area"}, {"radiance", colourJson(radiance)}};
}

}  // namespace ulam::pbrt
