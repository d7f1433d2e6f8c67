#pragma once
// envmap: radiance from all around, from a picture (Mitsuba 3 `envmap`), or from a clear sky with its sun (`sunsky`);
// importance-sampled (environment_map.h).

#include "core/scene/emitters/infinite.h"
#include "core/scene/environment_map.h"

#include <memory>

namespace ulam {

struct EnvmapEmitter {
    struct Parameters {
        double scale = 1;
        template <class V>
        void describe(V& v) {
            v("scale", scale, {.help = "factor on the picture", .min = 0});
        }
    };

    std::shared_ptr<const EnvironmentMap> map;

    static constexpr bool positionIsDelta = false;

    /// What enters the bounding sphere.
    double power(const EmissionContext& c) const { return map->totalLuminance() / discPdf(c); }

    Vertex samplePosition(const EmissionContext& c, const Block& u) const {
        Vertex v{};
        v.position = map->sample(u[1], u[2]);
        v.kind = Vertex::Kind::Infinite;
        v.shape = c.index;
        return v;
    }
    double positionPdf(const EmissionContext&, const Vertex& x0) const { return map->pdf(x0.position); }
    void invertPosition(const EmissionContext&, const Vertex& x0, Block& u) const {
        const Sample2 s = map->invert(x0.position, u[1]);
        u[1] = s.u;
        u[2] = s.v;
    }

    EmittedRay sampleDirection(const EmissionContext& c, const Vertex& x0, const Block& u) const { return rayThroughDisc(c, x0, u); }
    double directionPdf(const EmissionContext& c, const Vertex&, const Vec3f&) const { return discPdf(c); }
    void invertDirection(const EmissionContext& c, const Vertex& x0, const Vertex& x1, Block& u) const { invertDisc(c, x0, x1, u); }

    Spectrum radiance(const EmissionContext&, const Vertex& x0, const Vec3f&) const { return map->radiance(x0.position); }

    Vertex sampleDirect(const EmissionContext& c, const Vertex&, const Block& u) const { return samplePosition(c, u); }
    double directPdf(const EmissionContext& c, const Vertex&, const Vertex& x0) const { return positionPdf(c, x0); }
    void invertDirect(const EmissionContext& c, const Vertex& x0, Block& u) const { invertPosition(c, x0, u); }
};

}  // namespace ulam
