#pragma once
// What every emitter file uses. An emitter is a plain struct; beside each other it offers, for walks that start on it,
//   samplePosition(context, u)  → x0            positionPdf(context, x0)
//   sampleDirection(context, x0, u) → ray      directionPdf(context, x0, w)      w: direction of the light's travel
//   radiance(context, x0, w)                     L_e (area, infinite), intensity (point) or irradiance (directional) along w
// and for next-event estimation from a point of the scene
//   sampleDirect(context, from, u) → x0         directPdf(context, from, x0)
// each sampling routine with its inverse invert…: the numbers that give the same result, if there are any.
// Densities of positions: area measure; a delta position has 1, its δ is left out of f and p alike; for infinite
// emitters x0 is a direction with a density per solid angle, and "direction" is the point x1's place on the scene's
// disc, density 1/(πR²) per area of the disc.

#include "core/base/random.h"
#include "core/base/warp.h"
#include "core/scene/shape.h"
#include "core/scene/texture.h"

#include <optional>
#include <span>

namespace ulam {

struct BoundingSphere {
    Vec3f center{0, 0, 0};
    float radius = 1;
};

/// What an emitter may know of its scene.
struct EmissionContext {
    std::span<const Shape> shapes;
    std::span<const Texture> textures;
    BoundingSphere bounds;
    uint32_t index;  ///< of the emitter itself
};

/// Where a walk from an end of a path goes.
struct EmittedRay {
    Vec3f origin, direction;
    double pdf;  ///< of the direction (solid angle), or of the point on the disc (area)
};

}  // namespace ulam
