#pragma once
// area: a surface that shines evenly in all directions of its front (Mitsuba 3 `area`). The radiance may be textured; its
// points are chosen uniformly all the same.

#include "core/scene/emitters/emission.h"

namespace ulam {

struct AreaEmitter {
    struct Parameters {
        Spectrum radiance{1, 1, 1};
        template <class V>
        void describe(V& v) {
            v("radiance", radiance, {.help = "emitted radiance", .unit = "W/(m² sr)", .min = 0});
        }
    };

    Spectrum emitted;  ///< where it is textured: the mean over the surface
    uint32_t shape;
    uint32_t texture = kNone;

    static constexpr bool positionIsDelta = false;

    /// Watts: radiance × π × area, as luminance.
    double power(const EmissionContext& c) const { return luminance(emitted) * kPi * c.shapes[shape].area; }

    Vertex samplePosition(const EmissionContext& c, const Block& u) const {
        return c.shapes[shape].samplePoint(shape, u[1], u[2]);
    }
    double positionPdf(const EmissionContext& c, const Vertex&) const { return 1 / c.shapes[shape].area; }
    void invertPosition(const EmissionContext& c, const Vertex& x0, Block& u) const {
        const Sample2 s = c.shapes[shape].invertPoint(x0);
        u[1] = s.u;
        u[2] = s.v;
    }

    EmittedRay sampleDirection(const EmissionContext&, const Vertex& x0, const Block& u) const {
        const Vec3f local = squareToCosineHemisphere(u[0], u[1]);
        return {x0.position, Frame(x0.normal).toWorld(local), cosineHemispherePdf(double(local.z))};
    }
    double directionPdf(const EmissionContext&, const Vertex& x0, const Vec3f& w) const {
        return cosineHemispherePdf(double(dot(x0.normal, w)));
    }
    void invertDirection(const EmissionContext&, const Vertex& x0, const Vertex& x1, Block& u) const {
        const Sample2 s = cosineHemisphereToSquare(Frame(x0.normal).toLocal(directionTo(x0, x1)));
        u[0] = s.u;
        u[1] = s.v;
    }

    Spectrum radiance(const EmissionContext& c, const Vertex& x0, const Vec3f& w) const {
        if (!(dot(x0.normal, w) > 0)) return Spectrum(0.0);
        return texture == kNone ? emitted : textureColor(c.textures[texture], c.shapes[shape].texcoord(x0));
    }

    Vertex sampleDirect(const EmissionContext& c, const Vertex&, const Block& u) const { return samplePosition(c, u); }
    double directPdf(const EmissionContext& c, const Vertex&, const Vertex& x0) const { return positionPdf(c, x0); }
    void invertDirect(const EmissionContext& c, const Vertex& x0, Block& u) const { invertPosition(c, x0, u); }
};

}  // namespace ulam
