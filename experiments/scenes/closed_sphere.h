#pragma once
// What furnace and sphere_light_center share: a closed diffuse sphere with a camera inside, where radiance is the same
// everywhere and known for every number of bounces.

#include <cmath>

#include "core/config/json.h"

namespace ulam {

/// A camera away from the centre, looking at the inside of a sphere of radius 1 around the origin.
inline Json sensorInsideSphere() {
    return {{"type", "perspective"},
            {"fov", 70},
            {"to_world",
             Json::array(
                 {{{"type", "lookat"}, {"origin", {0.3, 0.2, -0.4}}, {"target", {0.0, 0.1, 1.0}}, {"up", {0, 1, 0}}}})},
            {"film", {{"type", "hdrfilm"}, {"width", 128}, {"height", 128}, {"rfilter", {{"type", "box"}}}}}};
}

/// The sphere, seen from inside.
inline Json hollowSphere(double reflectance) {
    return {{"type", "sphere"}, {"flip_normals", true}, {"bsdf", {{"type", "diffuse"}, {"reflectance", reflectance}}}};
}

/// 1 + r + … of `terms` terms; 0 or less: all of them.
inline double geometricSeries(double r, int terms) {
    return (terms > 0 ? 1 - std::pow(r, terms) : 1) / (1 - r);
}

}  // namespace ulam
