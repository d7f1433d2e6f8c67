#pragma once
// directional: parallel light from infinity (Mitsuba 3 `directional`). Its radiance is a delta function of the direction,
// which is left out of f and p alike; what remains is the irradiance of a surface that faces it.

#include "core/scene/emitters/delta_position.h"
#include "core/scene/emitters/infinite.h"

namespace ulam {

struct DirectionalEmitter : DeltaPosition {
    struct Parameters {
        Spectrum irradiance{1, 1, 1};
        template <class V>
        void describe(V& v) {
            v("irradiance", irradiance, {.help = "on a surface that faces the light", .unit = "W/m²", .min = 0});
        }
    };

    /// `travel`: unit direction in which the light travels.
    DirectionalEmitter(const Parameters& p, const Vec3f& travel) : DeltaPosition{-travel, Vertex::Kind::Direction}, irradiance(p.irradiance) {}

    Spectrum irradiance;

    /// What enters the bounding sphere.
    double power(const EmissionContext& c) const { return luminance(irradiance) / discPdf(c); }

    EmittedRay sampleDirection(const EmissionContext& c, const Vertex& x0, const Block& u) const { return rayThroughDisc(c, x0, u); }
    double directionPdf(const EmissionContext& c, const Vertex&, const Vec3f&) const { return discPdf(c); }
    void invertDirection(const EmissionContext& c, const Vertex& x0, const Vertex& x1, Block& u) const { invertDisc(c, x0, x1, u); }

    Spectrum radiance(const EmissionContext&, const Vertex&, const Vec3f&) const { return irradiance; }
};

}  // namespace ulam
