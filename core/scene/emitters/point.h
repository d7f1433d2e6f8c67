#pragma once
// point: the same intensity in all directions from one point (Mitsuba 3 `point`).

#include "core/scene/emitters/emission.h"

namespace ulam {

struct PointEmitter {
    struct Parameters {
        Spectrum intensity{1, 1, 1};
        template <class V>
        void describe(V& v) {
            v("intensity", intensity, {.help = "radiant intensity", .unit = "W/sr", .min = 0});
        }
    };

    Spectrum intensity;
    Vec3f position;

    static constexpr bool positionIsDelta = true;

    double power(const EmissionContext&) const { return luminance(intensity) * 4 * kPi; }

    Vertex samplePosition(const EmissionContext& c, const Block&) const {
        Vertex v{};
        v.position = position;
        v.kind = Vertex::Kind::Point;
        v.shape = c.index;
        return v;
    }
    double positionPdf(const EmissionContext&, const Vertex&) const { return 1; }
    void invertPosition(const EmissionContext&, const Vertex&, Block&) const {}

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

    Vertex sampleDirect(const EmissionContext& c, const Vertex&, const Block& u) const { return samplePosition(c, u); }
    double directPdf(const EmissionContext&, const Vertex&, const Vertex&) const { return 1; }
    void invertDirect(const EmissionContext&, const Vertex&, Block&) const {}
};

}  // namespace ulam
