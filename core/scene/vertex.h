#pragma once
// A vertex of a path: a point of the scene with its local geometry.

#include "core/base/vector.h"
#include "core/scene/lobe.h"

#include <type_traits>

namespace ulam {

struct Vertex {
    enum class Kind : uint8_t {
        Surface,   ///< a point of a shape
        Point,     ///< a point without surface: a point light, or a pinhole
        Infinite,  ///< a light at infinity: `position` is the unit direction towards it
    };

    Vec3f position;
    Vec3f normal;         ///< geometric, unit; Surface only
    Vec3f shadingNormal;  ///< unit; Surface only
    Vec2f uv;             ///< of the ray tracer's primitive (barycentric on triangles)
    uint32_t shape;       ///< index of the shape (Surface) or of the emitter (Point and Infinite, where it is a light)
    uint32_t primitive;   ///< triangle index within the shape
    Kind kind;
    Lobe lobe;            ///< how the path it belongs to scatters here

    bool onSurface() const { return kind == Kind::Surface; }
};
// Plain data; Imath 3.1 writes its copy constructors out, so the language does not call it trivially copyable.
static_assert(std::is_standard_layout_v<Vertex> && std::is_trivially_destructible_v<Vertex>);

/// Unit direction from a to b; at most one of them lies at infinity.
inline Vec3f directionTo(const Vertex& a, const Vertex& b) {
    if (b.kind == Vertex::Kind::Infinite) return b.position;
    if (a.kind == Vertex::Kind::Infinite) return -a.position;
    return normalize(b.position - a.position);
}

}  // namespace ulam
