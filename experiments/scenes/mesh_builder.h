#pragma once
// Meshes of generated scenes, corner by corner.

#include <array>
#include <functional>
#include <map>
#include <vector>

#include "core/base/vector.h"
#include "core/config/json.h"

namespace ulam {

/// Every vertex stands once (equal corners share it), so that neighbouring triangles meet without a gap.
class MeshBuilder {
public:
    /// Corners counter-clockwise, seen from the side that the normal points to.
    void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);
    void quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
    /// A plane convex polygon.
    void polygon(const std::vector<Vec3d>& corners);
    /// Quads a[i], b[i], b[i+1], a[i+1] between two polylines of as many points.
    void strip(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b);
    /// A parallelepiped with these edges at a corner; right-handed edges: the faces look outwards, left-handed: inwards.
    void box(const Vec3d& corner, const Vec3d& a, const Vec3d& b, const Vec3d& c);
    /// A box with edges along the axes, its faces outwards.
    void box(const Vec3d& lower, const Vec3d& upper);
    /// The surface that a profile of points (radius, height) sweeps around the y axis through `base`. Outside is to the
    /// right of a profile that goes up. Where it starts or ends on the axis, the surface is closed.
    void revolution(const std::vector<Imath::V2d>& profile, const Vec3d& base, int sides);

    bool empty() const { return triangles_.empty(); }
    /// The shape as a `mesh` plugin with this BSDF.
    Json shape(const Json& bsdf) const;

private:
    size_t vertex(const Vec3d& p);

    std::vector<double> positions_;
    std::vector<size_t> triangles_;
    std::map<std::array<double, 3>, size_t> vertices_;
};

/// The graph y = height(x, z) over a square around the origin, of cells × cells squares, seen from above.
Json heightField(int cells, double halfWidth, const std::function<double(double, double)>& height, const Json& bsdf);
/// A `mesh` with normals at its vertices, each the mean of its triangles' normals weighted by their angles.
Json smooth(Json shape);

Json diffuse(double reflectance);
Json areaEmitter(double radiance);
/// Turns a shape into a light that reflects nothing.
Json emitting(Json shape, double radiance);

}  // namespace ulam
