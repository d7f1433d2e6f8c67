#include "experiments/scenes/mesh_builder.h"

#include "core/scene/loading/geometry.h"

namespace ulam {

size_t MeshBuilder::vertex(const Vec3d& p) {
    const auto [place, isNew] = vertices_.try_emplace({p.x, p.y, p.z}, positions_.size() / 3);
    if (isNew) positions_.insert(positions_.end(), {p.x, p.y, p.z});
    return place->second;
}

void MeshBuilder::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const size_t i = vertex(a), j = vertex(b), k = vertex(c);
    if (i != j && j != k && k != i) triangles_.insert(triangles_.end(), {i, j, k});
}

void MeshBuilder::quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    triangle(a, b, c);
    triangle(a, c, d);
}

void MeshBuilder::polygon(const std::vector<Vec3d>& corners) {
    for (size_t i = 2; i < corners.size(); ++i) triangle(corners[0], corners[i - 1], corners[i]);
}

void MeshBuilder::strip(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    for (size_t i = 1; i < a.size(); ++i) quad(a[i - 1], b[i - 1], b[i], a[i]);
}

void MeshBuilder::box(const Vec3d& corner, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    // Each corner is computed once: sums in another order would round to other points, and faces would not share them.
    std::array<Vec3d, 8> corners;
    for (size_t i = 0; i < 8; ++i) corners[i] = corner + a * double(i & 1) + b * double(i >> 1 & 1) + c * double(i >> 2);
    for (const auto& [u, v] : {std::pair<size_t, size_t>(1, 2), std::pair<size_t, size_t>(2, 4), std::pair<size_t, size_t>(4, 1)}) {
        quad(corners[0], corners[v], corners[u | v], corners[u]);
        quad(corners[7], corners[7 ^ u], corners[7 ^ u ^ v], corners[7 ^ v]);
    }
}

void MeshBuilder::box(const Vec3d& lower, const Vec3d& upper) {
    const Vec3d edges = upper - lower;
    box(lower, {edges.x, 0, 0}, {0, edges.y, 0}, {0, 0, edges.z});
}

void MeshBuilder::revolution(const std::vector<Imath::V2d>& profile, const Vec3d& base, int sides) {
    std::vector<Vec3d> first, last, next;
    for (int i = 0; i <= sides; ++i) {
        const double angle = 2 * kPi * i / sides;
        next.clear();
        for (const Imath::V2d& p : profile)
            next.push_back(base + Vec3d(p.x * std::cos(angle), p.y, p.x * std::sin(angle)));
        // The seam is the same points, not points close to them.
        if (i == 0) first = next;
        if (i > 0) strip(i == sides ? first : next, last);
        last = next;
    }
}

Json MeshBuilder::shape(const Json& bsdf) const {
    return {{"type", "mesh"}, {"positions", positions_}, {"triangles", triangles_}, {"bsdf", bsdf}};
}

Json heightField(int cells, double halfWidth, const std::function<double(double, double)>& height, const Json& bsdf) {
    std::vector<double> positions;
    std::vector<size_t> triangles;
    const auto n = size_t(cells);
    for (size_t i = 0; i <= n; ++i)
        for (size_t j = 0; j <= n; ++j) {
            const double x = halfWidth * (2.0 * double(i) / double(n) - 1), z = halfWidth * (2.0 * double(j) / double(n) - 1);
            positions.insert(positions.end(), {x, height(x, z), z});
        }
    // Neighbouring squares share their corners.
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < n; ++j) {
            const size_t a = i * (n + 1) + j, b = a + n + 1;
            triangles.insert(triangles.end(), {a, a + 1, b + 1, a, b + 1, b});
        }
    return {{"type", "mesh"}, {"positions", positions}, {"triangles", triangles}, {"bsdf", bsdf}};
}

Json smooth(Json shape) {
    const auto positions = shape["positions"].get<std::vector<float>>();
    const auto triangles = shape["triangles"].get<std::vector<uint32_t>>();
    Mesh mesh;
    for (size_t i = 0; i < positions.size(); i += 3) mesh.positions.emplace_back(positions[i], positions[i + 1], positions[i + 2]);
    for (size_t i = 0; i < triangles.size(); i += 3) mesh.triangles.push_back({triangles[i], triangles[i + 1], triangles[i + 2]});
    std::vector<double> normals;
    for (const Vec3f& n : vertexNormals(mesh)) normals.insert(normals.end(), {n.x, n.y, n.z});
    shape["normals"] = normals;
    return shape;
}

Json diffuse(double reflectance) {
    return {{"type", "diffuse"}, {"reflectance", reflectance}};
}

Json areaEmitter(double radiance) {
    return {{"type", "area"}, {"radiance", radiance}};
}

Json emitting(Json shape, double radiance) {
    shape["bsdf"] = diffuse(0);
    shape["emitter"] = areaEmitter(radiance);
    return shape;
}

}  // namespace ulam
