#pragma once
// Shapes as the ray tracer and the light sampling see them. Surface parameters (u, v) follow Mitsuba 3.

#include "core/base/discrete.h"
#include "core/scene/vertex.h"

#include <Imath/ImathBox.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace ulam {

/// Triangles in world space, or in that of the shape group they belong to. `normals` is empty (flat shading) or one unit
/// vector a vertex; a zero vector leaves the vertex out of the interpolation.
struct Mesh {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;
    std::vector<Vec2f> texcoords;
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<Vec3f> faceNormals;  ///< geometric, unit, one a triangle; filled by Shape::prepare(), not in groups
    Imath::Box3f box;                ///< of the positions; filled by prepare()

    Vec3f point(uint32_t triangle, const Vec2f& uv) const {
        const auto& [i, j, k] = triangles[triangle];
        return positions[i] + (positions[j] - positions[i]) * uv.x + (positions[k] - positions[i]) * uv.y;
    }
    /// Call once the triangles are there: the box, and the room after the last vertex that the ray tracer reads over.
    void prepare();
};

/// A mesh of a shape group as an instance places it: the mesh is shared, so that an instance costs little. An instance's
/// meshes are shapes one after the other, which `member` counts.
struct MeshInstance {
    std::shared_ptr<const Mesh> mesh;
    uint32_t member = 0;
    std::array<Vec3f, 4> toWorld{Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1), Vec3f(0, 0, 0)};  ///< images of the axes and of the origin

    Vec3d toWorldPoint(const Vec3d& p) const { return toWorldVector(p) + Vec3d(toWorld[3]); }
    Vec3d toWorldVector(const Vec3d& v) const { return Vec3d(toWorld[0]) * v.x + Vec3d(toWorld[1]) * v.y + Vec3d(toWorld[2]) * v.z; }
    /// Of any length.
    Vec3d toWorldNormal(const Vec3d& n) const;
    Vec3f point(uint32_t triangle, const Vec2f& uv) const { return Vec3f(toWorldPoint(Vec3d(mesh->point(triangle, uv)))); }
};

/// Axes of an object in the world: unit vectors, orthogonal.
using Axes = std::array<Vec3f, 3>;
inline constexpr Axes kWorldAxes{Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1)};

/// u: azimuth / 2π around the third axis; v: angle to it / π.
struct Sphere {
    Vec3f center;
    float radius;
    Axes axes = kWorldAxes;
};

/// Any affine picture of the unit disc: center + x axisX + y axisY. (u, v) = (radius, azimuth / 2π) on the unit disc; a
/// vertex's `uv` holds (x, y).
struct Disk {
    Vec3f center, axisX, axisY, normal;
};

/// Open at both ends: the points at `radius` from the third axis, at heights 0 to `length` along it. u: azimuth / 2π;
/// v: height / length.
struct Cylinder {
    Vec3f base;
    float radius, length;
    Axes axes = kWorldAxes;
};

/// ∂p/∂u and ∂p/∂v of the parametrisation that texcoord() gives. Where one of them vanishes (at the poles of a sphere and
/// the centre of a disk), a vector along its limit stands for it, of any length but 0.
struct Tangents {
    Vec3f u, v;
};

inline constexpr uint32_t kNone = 0xffffffffu;

struct Shape {
    std::variant<Mesh, Sphere, Disk, Cylinder, MeshInstance> geometry;
    uint32_t material = 0;    ///< index into Scene::materials
    uint32_t emitter = kNone; ///< index into Scene::emitters of its area light
    bool flipNormals = false; ///< normals of a sphere or cylinder point inwards (others have it in their data)
    std::string id;           ///< the name in the scene file
    double area = 0;          ///< of a mesh only where it emits
    DiscreteDistribution triangles;  ///< by area; emitting meshes only

    /// Fills normal and shading normal of a vertex whose shape, primitive, uv and position are set.
    void setNormals(Vertex& v) const;
    /// Surface parameters of a vertex, for textures.
    Vec2f texcoord(const Vertex& v) const;
    /// Derivatives by the surface parameters; on a mesh without texture coordinates, any frame of the normal.
    Tangents tangents(const Vertex& v) const;
    /// ∂p/∂u, for anisotropic BSDFs.
    Vec3f tangent(const Vertex& v) const { return tangents(v).u; }
    /// A point uniform by area from two numbers (density 1 / area), and the numbers of a point.
    Vertex samplePoint(uint32_t shapeIndex, double u, double v) const;
    Sample2 invertPoint(const Vertex& v) const;
    /// Holds the shape.
    Imath::Box3f bounds() const;
    /// Face normals, area and, on emitters, the distribution over triangles: call once the geometry is there.
    void prepare();
    /// The triangles, in world space or in a group's; null of other shapes.
    const Mesh* triangleMesh() const;
};

}  // namespace ulam
