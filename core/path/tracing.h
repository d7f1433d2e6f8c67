#pragma once
// Rays between vertices: where a walk goes next, and whether two vertices see each other.

#include "core/base/non_finite.h"
#include "core/path/measure.h"
#include "core/scene/scene.h"

namespace ulam {

/// One thread's access to the ray tracer; counts its rays.
class Tracing {
public:
    explicit Tracing(const Scene& scene)
        : scene_(&scene), offset_(4e-6f * (scene.bounds().radius + length(scene.bounds().center))) {}

    const Scene& scene() const { return *scene_; }
    uint64_t rays() const { return rays_; }
    void addRays(uint64_t rays) { rays_ += rays; }
    /// How far from its surface a ray starts: positions and directions of vertices are as good as that.
    float offsetLength() const { return offset_; }

    /// Where a ray from v along w starts: off the surface along the geometric normal, by a few dozen units in the last
    /// place of the scene's coordinates.
    Vec3f rayOrigin(const Vertex& v, const Vec3f& w) const {
        if (!v.onSurface()) return v.position;
        return v.position + v.normal * (dot(v.normal, w) > 0 ? offset_ : -offset_);
    }

    /// The vertex that a ray from v along w meets; leaving the scene, the environment's vertex if there is one.
    bool next(const Vertex& v, const Vec3f& w, Vertex& hit) { return nextFrom(rayOrigin(v, w), w, hit); }

    /// The direction of the ray from `from` that meets `to`, up to rounding. That between their places differs by what
    /// rays start off the surface, always to the same side: steps measured by it drift.
    Vec3f directionOfRay(const Vertex& from, const Vertex& to) const {
        if (to.atInfinity()) return to.position;
        return normalize(to.position - rayOrigin(from, to.position - from.position));
    }

    bool nextFrom(const Vec3f& origin, const Vec3f& w, Vertex& out) {
        ++rays_;
        Hit hit;
        if (scene_->rays().intersect(origin, w, hit)) {
            scene_->vertexAt(origin, w, hit, out);
            const Vec3f sum = out.position + out.normal + out.shadingNormal;
            return checkFinite(Cause::Geometry, sum.x + sum.y + sum.z);
        }
        if (scene_->environment == kNone) return false;
        out = Vertex{};
        out.position = w;
        out.kind = Vertex::Kind::Infinite;
        out.shape = scene_->environment;
        return true;
    }

    /// V(a↔b). Asked in the order light, camera, so that the answer is a function of the pair. The ray starts where
    /// coordinates are smaller: its direction is rounded as the larger ones are, and what is close to its start is met
    /// as surely as from a camera there, what is close to its end is not.
    bool visible(const Vertex& a, const Vertex& b) {
        ++rays_;
        if (a.atInfinity()) return !scene_->rays().occludedToInfinity(rayOrigin(b, a.position), a.position);
        const Vec3f d = b.position - a.position;
        Vec3f from = rayOrigin(a, d), to = rayOrigin(b, -d);
        if (to.dot(to) < from.dot(from)) std::swap(from, to);
        return !scene_->rays().occluded(from, to - from);
    }

private:
    const Scene* scene_;
    float offset_;
    uint64_t rays_ = 0;
};

}  // namespace ulam
