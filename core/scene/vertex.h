#pragma once
// A vertex of a path: a point of the scene with its local geometry.

#include "core/base/vector.h"
#include "core/scene/lobe.h"

#include <type_traits>

namespace ulam {

struct Vertex {
    enum class Kind : uint8_t {
        Surface,    ///< a point of a shape
        Lens,       ///< a point of the camera's aperture, which no ray can hit
        Point,      ///< a point without surface: a point light, or a pinhole
        Infinite,   ///< a light all around at infinity: `position` is the unit direction towards x_0
        Direction,  ///< a light at infinity that shines from one direction, likewise
    };

    Vec3f position;
    Vec3f normal;         ///< geometric, unit; Surface and Lens
    Vec3f shadingNormal;  ///< unit; Surface only
    Vec2f uv;             ///< of the ray tracer's primitive (barycentric on triangles)
    uint32_t shape;       ///< index of the shape (Surface) or of the emitter (other lights)
    uint32_t primitive;   ///< triangle index within the shape
    Kind kind;
    Lobe lobe;            ///< how the path it belongs to scatters here

    /// What is used of it.
    template <class Archive>
    void archive(Archive& a) {
        a(kind, lobe, shape, position);
        if (hasNormal()) a(normal);
        if (onSurface()) a(shadingNormal, uv, primitive);
    }

    bool onSurface() const { return kind == Kind::Surface; }
    bool hasNormal() const { return kind == Kind::Surface || kind == Kind::Lens; }
    bool atInfinity() const { return kind == Kind::Infinite || kind == Kind::Direction; }
};
// Plain data; Imath 3.1 writes its copy constructors out, so the language does not call it trivially copyable.
static_assert(std::is_standard_layout_v<Vertex> && std::is_trivially_destructible_v<Vertex>);

/// Unit direction from a to b; at most one of them lies at infinity.
inline Vec3f directionTo(const Vertex& a, const Vertex& b) {
    if (b.atInfinity()) return b.position;
    if (a.atInfinity()) return -a.position;
    return normalize(b.position - a.position);
}

}  // namespace ulam
