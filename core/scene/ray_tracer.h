#pragma once
// Rays against the scene. The only place that knows Embree (version 3 or 4).

#include "core/scene/shape.h"

#include <memory>
#include <span>
#include <string>

namespace ulam {

struct Hit {
    uint32_t shape, primitive;
    float distance;
    Vec2f uv;  ///< barycentric on triangles; a place on the unit disc (Disk)
};

/// What the ray tracer's tree over some shapes takes.
struct TreeMemory {
    double building, built;  ///< bytes: at most while it is made, and afterwards
};
TreeMemory treeMemory(std::span<const Shape> shapes);

/// The vector instructions that rays are traced with, the widest that the ray tracer and this processor know: "sse", "avx",
/// "avx2" or "avx512". They decide how distances are rounded.
std::string rayTracerInstructions();

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
