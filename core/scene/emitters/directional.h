#pragma once
// directional: parallel light from infinity (Mitsuba 3 `directional`). Its radiance is a delta function of the direction,
// which is left out of f and p alike; what remains is the irradiance of a surface that faces it.

#include "core/scene/emitters/infinite.h"

namespace ulam {

struct DirectionalEmitter {
    struct Parameters {
        Spectrum irradiance{1, 1, 1};
        template <class V>
        void describe(V& v) {
            v("irradiance", irradiance, {.help = "on a surface that faces the light", .unit = "W/m²", .min = 0});
        }
    };

    Spectrum irradiance;
    Vec3f travel;  ///< unit direction in which the light travels

    static constexpr bool positionIsDelta = true;

    /// What enters the bounding sphere.
    double power(const EmissionContext& c) const { return luminance(irradiance) / discPdf(c); }

    Vertex samplePosition(const EmissionContext& c, const Block&) const {
        Vertex v{};
        v.position = -travel;
        v.kind = Vertex::Kind::Direction;
        v.shape = c.index;
        return v;
    }
    double positionPdf(const EmissionContext&, const Vertex&) const { return 1; }
    void invertPosition(const EmissionContext&, const Vertex&, Block&) const {}

    EmittedRay sampleDirection(const EmissionContext& c, const Vertex& x0, const Block& u) const { return rayThroughDisc(c, x0, u); }
    double directionPdf(const EmissionContext& c, const Vertex&, const Vec3f&) const { return discPdf(c); }
    void invertDirection(const EmissionContext& c, const Vertex& x0, const Vertex& x1, Block& u) const { invertDisc(c, x0, x1, u); }

    Spectrum radiance(const EmissionContext&, const Vertex&, const Vec3f&) const { return irradiance; }

    Vertex sampleDirect(const EmissionContext& c, const Vertex&, const Block& u) const { return samplePosition(c, u); }
    double directPdf(const EmissionContext&, const Vertex&, const Vertex&) const { return 1; }
    void invertDirect(const EmissionContext&, const Vertex&, Block&) const {}
};

}  // namespace ulam
