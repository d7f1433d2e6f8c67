#include "core/scene/shape.h"

namespace ulam {
namespace {

/// Along the geometric normal, as long as twice the area; in double, for slivers far from the origin.
Vec3d areaVector(const Mesh& mesh, const std::array<uint32_t, 3>& t) {
    const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    return (b - a).cross(c - a);
}

}  // namespace

void Shape::setNormals(Vertex& v) const {
    if (const Mesh* mesh = std::get_if<Mesh>(&geometry)) {
        v.normal = v.shadingNormal = mesh->faceNormals[v.primitive];
        if (mesh->normals.empty()) return;
        const auto& [i, j, k] = mesh->triangles[v.primitive];
        const Vec3f n =
            mesh->normals[i] * (1 - v.uv.x - v.uv.y) + mesh->normals[j] * v.uv.x + mesh->normals[k] * v.uv.y;
        // Opposite normals may cancel out.
        if (length2(n) > 0) v.shadingNormal = normalize(n);
    } else {
        const Vec3f outward = normalize(v.position - std::get<Sphere>(geometry).center);
        v.normal = v.shadingNormal = flipNormals ? -outward : outward;
    }
}

Vertex Shape::samplePoint(uint32_t shapeIndex, double u, double v) const {
    Vertex x{};
    x.kind = Vertex::Kind::Surface;
    x.lobe = Lobe::Smooth;
    x.shape = shapeIndex;
    if (const Mesh* mesh = std::get_if<Mesh>(&geometry)) {
        x.primitive = uint32_t(triangles.sample(u));
        x.uv = squareToTriangle(u, v);
        const auto& [i, j, k] = mesh->triangles[x.primitive];
        const Vec3f &a = mesh->positions[i], &b = mesh->positions[j], &c = mesh->positions[k];
        x.position = a + (b - a) * x.uv.x + (c - a) * x.uv.y;
    } else {
        const Sphere& sphere = std::get<Sphere>(geometry);
        x.position = sphere.center + squareToSphere(u, v) * sphere.radius;
    }
    setNormals(x);
    return x;
}

Sample2 Shape::invertPoint(const Vertex& v) const {
    if (const Sphere* sphere = std::get_if<Sphere>(&geometry))
        return sphereToSquare(normalize(v.position - sphere->center));
    const Sample2 s = triangleToSquare(v.uv);
    return {triangles.invert(v.primitive, s.u), s.v};
}

void Shape::prepare() {
    if (const Sphere* sphere = std::get_if<Sphere>(&geometry)) {
        area = 4 * kPi * sphere->radius * sphere->radius;
        return;
    }
    Mesh& mesh = std::get<Mesh>(geometry);
    std::vector<double> areas;
    mesh.faceNormals.clear();
    mesh.faceNormals.reserve(mesh.triangles.size());
    area = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3d n = areaVector(mesh, t);
        mesh.faceNormals.emplace_back(n.normalized());
        areas.push_back(n.length() / 2);
        area += areas.back();
    }
    if (emitter != kNone) triangles = DiscreteDistribution(areas);
}

}  // namespace ulam
