#pragma once
// Shapes as the ray tracer and the light sampling see them: triangle meshes and spheres.

#include "core/base/discrete.h"
#include "core/scene/vertex.h"

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace ulam {

/// Triangles in world space. `normals` is empty (flat shading) or one unit vector a vertex; a
/// zero vector leaves the vertex out of the interpolation.
struct Mesh {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;
    std::vector<Vec2f> texcoords;
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<Vec3f> faceNormals;  ///< geometric, unit, one a triangle; filled by Shape::prepare()
};

struct Sphere {
    Vec3f center;
    float radius;
};

inline constexpr uint32_t kNone = 0xffffffffu;

struct Shape {
    std::variant<Mesh, Sphere> geometry;
    uint32_t material = 0;    ///< index into Scene::materials
    uint32_t emitter = kNone; ///< index into Scene::emitters of its area light
    bool flipNormals = false; ///< normals of a sphere point inwards (a mesh has it in its data)
    std::string id;           ///< the name in the scene file
    double area = 0;
    DiscreteDistribution triangles;  ///< by area; emitting meshes only

    /// Fills normal and shading normal of a vertex whose shape, primitive, uv and position are set.
    void setNormals(Vertex& v) const;
    /// A point uniform by area from two numbers (density 1 / area), and the numbers of a point.
    Vertex samplePoint(uint32_t shapeIndex, double u, double v) const;
    Sample2 invertPoint(const Vertex& v) const;
    /// Face normals, area and, on emitters, the distribution over triangles: call once the geometry is there.
    void prepare();
};

}  // namespace ulam
