#pragma once
// Meshes of generated scenes, corner by corner.

#include <array>
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

    bool empty() const { return triangles_.empty(); }
    /// The shape as a `mesh` plugin with this BSDF.
    Json shape(const Json& bsdf) const;

private:
    size_t vertex(const Vec3d& p);

    std::vector<double> positions_;
    std::vector<size_t> triangles_;
    std::map<std::array<double, 3>, size_t> vertices_;
};

Json diffuse(double reflectance);
Json areaEmitter(double radiance);
/// Turns a shape into a light that reflects nothing.
Json emitting(Json shape, double radiance);

}  // namespace ulam
