#pragma once
// Rays against the scene. The only place that knows Embree (version 3 or 4).

#include "core/scene/shape.h"

#include <memory>
#include <span>

namespace ulam {

struct Hit {
    uint32_t shape, primitive;
    float distance;
    Vec2f uv;  ///< barycentric on triangles; a place on the unit disc (Disk)
};

class RayTracer {
public:
    RayTracer();
    /// The meshes are read in place from then on: they must stay where they are, prepared.
    explicit RayTracer(std::span<const Shape> shapes);
    ~RayTracer();
    RayTracer(RayTracer&&) noexcept;
    RayTracer& operator=(RayTracer&&) noexcept;

    /// Nearest hit with 0 < distance < infinity. `direction` need not be unit; distance is in its units.
    bool intersect(const Vec3f& origin, const Vec3f& direction, Hit& hit) const;
    /// Is anything strictly between origin and origin + segment?
    bool occluded(const Vec3f& origin, const Vec3f& segment) const;
    /// Is anything along the ray, however far?
    bool occludedToInfinity(const Vec3f& origin, const Vec3f& direction) const;

private:
    struct Embree;
    std::unique_ptr<Embree> embree_;
};

}  // namespace ulam
