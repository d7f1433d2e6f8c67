#pragma once
// What lights at a given point or from a given direction share: x_0 is no choice, and its δ is left out of f and p alike.

#include "core/scene/emitters/emission.h"

namespace ulam {

struct DeltaPosition {
    Vec3f position;  ///< or the unit direction towards the light
    Vertex::Kind kind;  ///< Point or Direction

    static constexpr bool positionIsDelta = true;

    Vertex samplePosition(const EmissionContext& c, const Block&) const {
        Vertex v{};
        v.position = position;
        v.kind = kind;
        v.shape = c.index;
        return v;
    }
    double positionPdf(const EmissionContext&, const Vertex&) const { return 1; }
    void invertPosition(const EmissionContext&, const Vertex&, Block&) const {}

    Vertex sampleDirect(const EmissionContext& c, const Vertex&, const Block& u) const { return samplePosition(c, u); }
    double directPdf(const EmissionContext&, const Vertex&, const Vertex&) const { return 1; }
    void invertDirect(const EmissionContext&, const Vertex&, Block&) const {}
};

}  // namespace ulam
