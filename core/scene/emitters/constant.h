#pragma once
// constant: the same radiance from every direction at infinity (Mitsuba 3 `constant`).

#include "core/scene/emitters/infinite.h"

namespace ulam {

struct ConstantEmitter {
    struct Parameters {
        Spectrum radiance{1, 1, 1};
        template <class V>
        void describe(V& v) {
            v("radiance", radiance, {.help = "radiance from every direction", .unit = "W/(m² sr)", .min = 0});
        }
    };

    Spectrum emitted;

    static constexpr bool positionIsDelta = false;

    /// What enters the bounding sphere.
    double power(const EmissionContext& c) const { return luminance(emitted) * 4 * kPi / discPdf(c); }

    Vertex samplePosition(const EmissionContext& c, const Block& u) const {
        Vertex v{};
        v.position = squareToSphere(u[1], u[2]);
        v.kind = Vertex::Kind::Infinite;
        v.shape = c.index;
        return v;
    }
    double positionPdf(const EmissionContext&, const Vertex&) const { return kSpherePdf; }
    void invertPosition(const EmissionContext&, const Vertex& x0, Block& u) const {
        const Sample2 s = sphereToSquare(x0.position);
        u[1] = s.u;
        u[2] = s.v;
    }

    EmittedRay sampleDirection(const EmissionContext& c, const Vertex& x0, const Block& u) const { return rayThroughDisc(c, x0, u); }
    double directionPdf(const EmissionContext& c, const Vertex&, const Vec3f&) const { return discPdf(c); }
    void invertDirection(const EmissionContext& c, const Vertex& x0, const Vertex& x1, Block& u) const { invertDisc(c, x0, x1, u); }

    Spectrum radiance(const EmissionContext&, const Vertex&, const Vec3f&) const { return emitted; }

    Vertex sampleDirect(const EmissionContext& c, const Vertex&, const Block& u) const { return samplePosition(c, u); }
    double directPdf(const EmissionContext&, const Vertex&, const Vertex&) const { return kSpherePdf; }
    void invertDirect(const EmissionContext& c, const Vertex& x0, Block& u) const { invertPosition(c, x0, u); }
};

}  // namespace ulam
