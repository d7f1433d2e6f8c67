#include "core/scene/loading/geometry.h"

#include <fmt/format.h>

#include "core/scene/loading/transform.h"

namespace ulam {
namespace {

bool finite(const Vec3f& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

float largest(const Vec3f& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

void checkIndices(const Mesh& mesh, const JsonNode& shape) {
    for (const auto& triangle : mesh.triangles)
        for (const uint32_t index : triangle)
            if (index >= mesh.positions.size())
                shape.fail(fmt::format("a triangle names vertex {}, but there are {} (counted from 0)", index,
                                       mesh.positions.size()));
}

bool isDegenerate(const Mesh& mesh, const std::array<uint32_t, 3>& t) {
    const Vec3f a = mesh.positions[t[0]], e = mesh.positions[t[1]] - a, f = mesh.positions[t[2]] - a;
    // In single precision, as the ray tracer sees it.
    return !(largest(cross(e, f)) > 0);
}

Vec3f transformedNormal(const Vec3f& n, const Matrix4& inverseTranspose) {
    Vec3d out;
    inverseTranspose.multDirMatrix(Vec3d(n), out);
    return out.length() > 0 ? Vec3f(out.normalized()) : Vec3f(0.0f);
}

}  // namespace

std::vector<Vec3f> vertexNormals(const Mesh& mesh) {
    std::vector<Vec3d> sums(mesh.positions.size(), Vec3d(0.0));
    for (const auto& t : mesh.triangles) {
        const Vec3d p[3] = {Vec3d(mesh.positions[t[0]]), Vec3d(mesh.positions[t[1]]), Vec3d(mesh.positions[t[2]])};
        const Vec3d n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
        for (int i = 0; i < 3; ++i) {
            const Vec3d e = p[(i + 1) % 3] - p[i], f = p[(i + 2) % 3] - p[i];
            sums[t[size_t(i)]] += n * std::atan2(e.cross(f).length(), e.dot(f));
        }
    }
    std::vector<Vec3f> normals;
    normals.reserve(sums.size());
    for (const Vec3d& sum : sums) normals.emplace_back(sum.normalized());
    return normals;
}

Mesh placeMesh(Mesh mesh, const MeshPlacement& placement, const JsonNode& shape, LoadContext& context) {
    checkIndices(mesh, shape);
    for (Vec3f& p : mesh.positions) {
        Vec3d out;
        placement.toWorld.multVecMatrix(Vec3d(p), out);
        p = Vec3f(out);
        if (!finite(p) || largest(p) > kLargestCoordinate)
            shape.fail(fmt::format("a vertex is not finite, or beyond {:g}", kLargestCoordinate));
    }
    const size_t degenerate =
        std::erase_if(mesh.triangles, [&](const auto& triangle) { return isDegenerate(mesh, triangle); });
    if (degenerate > 0)
        context.warnings.push_back(
            fmt::format("{} degenerate triangle(s) dropped from the shape at {}", degenerate, shape.where()));
    if (mesh.triangles.empty()) shape.fail("the mesh has no triangles with an area");

    if (placement.normals == MeshPlacement::Normals::Flat) mesh.normals.clear();
    if (!mesh.normals.empty()) {
        const Matrix4 inverseTranspose = placement.toWorld.inverse().transposed();
        for (Vec3f& n : mesh.normals) {
            if (!finite(n)) shape.fail("a vertex normal is not finite");
            n = transformedNormal(placement.flipNormals ? -n : n, inverseTranspose);
        }
    }
    // Where there are vertex normals, they say which side is the front, whatever the winding.
    const auto backward = [&](const std::array<uint32_t, 3>& t) {
        if (mesh.normals.empty()) return placement.flipNormals;
        const Vec3f e = mesh.positions[t[1]] - mesh.positions[t[0]], f = mesh.positions[t[2]] - mesh.positions[t[0]];
        return dot(cross(e, f), mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]) < 0;
    };
    for (auto& triangle : mesh.triangles)
        if (backward(triangle)) std::swap(triangle[1], triangle[2]);
    if (mesh.normals.empty() && placement.normals == MeshPlacement::Normals::Smooth) mesh.normals = vertexNormals(mesh);
    mesh.prepare();
    return mesh;
}

}  // namespace ulam
