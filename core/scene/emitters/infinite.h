#pragma once
// What emitters at infinity share: rays towards the scene through a disc that hides it, x_0 being a direction.

#include "core/scene/emitters/emission.h"

namespace ulam {

/// Density of a point of the disc, per area.
inline double discPdf(const EmissionContext& c) { return 1 / (kPi * c.bounds.radius * c.bounds.radius); }

/// From u[0] and u[1].
inline EmittedRay rayThroughDisc(const EmissionContext& c, const Vertex& x0, const Block& u) {
    const Frame frame(x0.position);
    const Vec2f d = squareToDisc(u[0], u[1]) * c.bounds.radius;
    return {c.bounds.center + frame.s * d.x + frame.t * d.y + frame.n * c.bounds.radius, -x0.position, discPdf(c)};
}

inline void invertDisc(const EmissionContext& c, const Vertex& x0, const Vertex& x1, Block& u) {
    const Vec3f d = Frame(x0.position).toLocal(x1.position - c.bounds.center) / c.bounds.radius;
    const Sample2 s = discToSquare(d.x, d.y);
    u[0] = s.u;
    u[1] = s.v;
}

}  // namespace ulam
