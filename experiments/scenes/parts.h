#pragma once
// Pieces of scene dictionaries that several generators share.

#include "core/config/json.h"
#include "experiments/scenes/mesh_builder.h"

namespace ulam {

/// [x, y, z] of a point, a direction or a colour.
Json triple(const Vec3d& v);

/// A camera with a box filter; `fov` in degrees along the film's width.
struct View {
    Vec3d origin, target, up;
    double fov;
    int width = 256, height = 256;
    Json sensor() const;
};

Json diffuse(const Spectrum& reflectance);
Json twosided(const Json& bsdf);
/// Microfacets of roughness alpha; below 0.0001, which is the least that these BSDFs have, a smooth surface.
Json glass(double alpha, double ior);
/// A metal by its name in core/scene/bsdfs/metals.h; roughness as for glass.
Json metal(const char* material, double alpha);

Json sphere(const Vec3d& center, double radius, const Json& bsdf);
/// An open cylinder, seen from both sides.
Json tube(const Vec3d& p0, const Vec3d& p1, double radius, const Json& bsdf);
/// A disc around `center` whose normal points to `target`.
Json disk(const Vec3d& center, const Vec3d& target, double radius);
/// A disc that shines on `target`, from where it is seen under the angle `width` (degrees). A surface there that faces it
/// receives `irradiance`, whatever the width: E = π L sin²(width / 2) on the axis of a Lambertian disc.
Json discLight(const Vec3d& center, const Vec3d& target, double width, double irradiance);

Json emitting(Json shape, const Spectrum& radiance);

}  // namespace ulam
