#pragma once
// A scene ready to be rendered: shapes, materials, emitters, sensor and ray tracing, in flat arrays that vertices index.

#include "core/base/memory.h"
#include "core/image/filter.h"
#include "core/scene/emitter.h"
#include "core/scene/features.h"
#include "core/scene/material.h"
#include "core/scene/ray_tracer.h"
#include "core/scene/sensors/perspective.h"

#include <functional>
#include <string>
#include <vector>

namespace ulam {

class Scene {
public:
    std::vector<Shape> shapes;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Emitter> emitters;
    uint32_t environment = kNone;  ///< index of the emitter at infinity
    std::optional<Perspective> sensor;
    ReconstructionFilter filter;
    Features features;
    std::vector<std::string> warnings;  ///< e.g. counted degenerate triangles
    std::vector<std::string> substitutions;  ///< what is not as its file says, in words: images of it are biased
    std::string hash;                   ///< SHA-256 of everything that determines images of this scene

    /// Call once after the arrays are filled: areas, bounds, light selection, acceleration structure. Fails with
    /// InvalidConfig where the memory for it is not allowed.
    void finalize();

    /// What it takes: its meshes and pictures, and last the ray tracer's tree, once built or at most while it is built.
    enum class Tree { Built, Building };
    MemoryNeeds memory(Tree tree = Tree::Built) const;

    EmissionContext emission(uint32_t emitter) const { return {shapes, textures, bounds_, emitter}; }
    const BoundingSphere& bounds() const { return bounds_; }
    /// Emitters are chosen by power, for emission and for next-event estimation alike.
    const DiscreteDistribution& emitterChoice() const { return emitterChoice_; }
    const RayTracer& rays() const { return rays_; }

    /// The emitter that shines at a vertex, or kNone.
    uint32_t emitterAt(const Vertex& v) const {
        return v.onSurface() ? shapes[v.shape].emitter : v.shape;
    }
    const Material& materialAt(const Vertex& v) const { return materials[shapes[v.shape].material]; }

    /// Makes v the vertex at a hit of a ray. In place: a copy right after so many small writes would wait for them.
    void vertexAt(const Vec3f& origin, const Vec3f& direction, const Hit& hit, Vertex& v) const;

private:
    Spectrum meanRadiance(const AreaEmitter& area) const;

    BoundingSphere bounds_;
    DiscreteDistribution emitterChoice_;
    RayTracer rays_;
};

}  // namespace ulam
