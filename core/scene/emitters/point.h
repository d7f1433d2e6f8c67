#pragma once
// point: the same intensity in all directions from one point (Mitsuba 3 `point`).

#include "core/scene/emitters/delta_position.h"

namespace ulam {

struct PointEmitter : DeltaPosition {
    struct Parameters {
        Spectrum intensity{1, 1, 1};
        template <class V>
        void describe(V& v) {
            v("intensity", intensity, {.help = "radiant intensity", .unit = "W/sr", .min = 0});
        }
    };

    PointEmitter(const Parameters& p, const Vec3f& place) : DeltaPosition{place, Vertex::Kind::Point}, intensity(p.intensity) {}

    Spectrum intensity;

    double power(const EmissionContext&) const { return luminance(intensity) * 4 * kPi; }

    EmittedRay sampleDirection(const EmissionContext&, const Vertex&, const Block& u) const {
        return {position, squareToSphere(u[0], u[1]), kSpherePdf};
    }
    double directionPdf(const EmissionContext&, const Vertex&, const Vec3f&) const { return kSpherePdf; }
    void invertDirection(const EmissionContext&, const Vertex& x0, const Vertex& x1, Block& u) const {
        const Sample2 s = sphereToSquare(directionTo(x0, x1));
        u[0] = s.u;
        u[1] = s.v;
    }

    Spectrum radiance(const EmissionContext&, const Vertex&, const Vec3f&) const { return intensity; }
};

}  // namespace ulam
