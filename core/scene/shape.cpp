#include "core/scene/shape.h"

namespace ulam {
namespace {

/// Along the geometric normal, as long as twice the area; in double, for slivers far from the origin.
Vec3d areaVector(const Mesh& mesh, uint32_t triangle) {
    const auto& t = mesh.triangles[triangle];
    const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    return (b - a).cross(c - a);
}
/// What toWorldNormal makes of a vector of twice the area is a vector of twice the area.
Vec3d areaVector(const MeshInstance& instance, uint32_t triangle) { return instance.toWorldNormal(areaVector(*instance.mesh, triangle)); }

/// Of a mesh that has normals; zero where opposite ones cancel out.
Vec3f interpolatedNormal(const Mesh& mesh, const Vertex& v) {
    const auto& [i, j, k] = mesh.triangles[v.primitive];
    return mesh.normals[i] * (1 - v.uv.x - v.uv.y) + mesh.normals[j] * v.uv.x + mesh.normals[k] * v.uv.y;
}

Vec3f inAxes(const Axes& axes, const Vec3f& v) { return {dot(v, axes[0]), dot(v, axes[1]), dot(v, axes[2])}; }

Vec3f outward(const Sphere& sphere, const Vec3f& p) { return normalize(p - sphere.center); }
Vec3f outward(const Cylinder& cylinder, const Vec3f& p) {
    const Vec3f place = inAxes(cylinder.axes, p - cylinder.base);
    return normalize(cylinder.axes[0] * place.x + cylinder.axes[1] * place.y);
}

Vec2f texcoordOf(const Mesh& mesh, const Vertex& v) {
    if (mesh.texcoords.empty()) return v.uv;
    const auto& [i, j, k] = mesh.triangles[v.primitive];
    return mesh.texcoords[i] * (1 - v.uv.x - v.uv.y) + mesh.texcoords[j] * v.uv.x + mesh.texcoords[k] * v.uv.y;
}
Vec2f texcoordOf(const MeshInstance& instance, const Vertex& v) { return texcoordOf(*instance.mesh, v); }
Vec2f texcoordOf(const Sphere& sphere, const Vertex& v) {
    const Vec3f p = inAxes(sphere.axes, v.position - sphere.center);
    return {float(inverseAzimuth(p.x, p.y)), float(std::atan2(std::hypot(p.x, p.y), p.z) / kPi)};
}
Vec2f texcoordOf(const Disk&, const Vertex& v) { return {v.uv.length(), float(inverseAzimuth(v.uv.x, v.uv.y))}; }
Vec2f texcoordOf(const Cylinder& cylinder, const Vertex& v) {
    const Vec3f p = inAxes(cylinder.axes, v.position - cylinder.base);
    return {float(inverseAzimuth(p.x, p.y)), p.z / cylinder.length};
}

Tangents tangentsOf(const Mesh& mesh, const Vertex& v, const Vec3f& normal) {
    if (!mesh.texcoords.empty()) {
        const auto& [i, j, k] = mesh.triangles[v.primitive];
        const Vec2f a = mesh.texcoords[j] - mesh.texcoords[i], b = mesh.texcoords[k] - mesh.texcoords[i];
        const Vec3f e = mesh.positions[j] - mesh.positions[i], f = mesh.positions[k] - mesh.positions[i];
        const float scale = 1 / (a.x * b.y - a.y * b.x);
        const Tangents t{(e * b.y - f * a.y) * scale, (f * a.x - e * b.x) * scale};
        // Not where the texture coordinates are all on one line, nor where they or the edges are beyond single precision.
        const auto usable = [](const Vec3f& d) { return length2(d) > 0 && std::isfinite(length2(d)); };
        if (usable(t.u) && usable(t.v)) return t;
    }
    const Frame frame(normal);
    return {frame.s, frame.t};
}
Tangents tangentsOf(const Mesh& mesh, const Vertex& v) { return tangentsOf(mesh, v, v.normal); }
Tangents tangentsOf(const MeshInstance& instance, const Vertex& v) {
    const Tangents t = tangentsOf(*instance.mesh, v, Vec3f(areaVector(*instance.mesh, v.primitive).normalized()));
    return {Vec3f(instance.toWorldVector(Vec3d(t.u))), Vec3f(instance.toWorldVector(Vec3d(t.v)))};
}
/// ∂p/∂u of an azimuth 2πu around the third axis.
Vec3f aroundAxis(const Axes& axes, float x, float y) { return (axes[1] * x - axes[0] * y) * float(2 * kPi); }

Tangents tangentsOf(const Sphere& sphere, const Vertex& v) {
    const Axes& axes = sphere.axes;
    const Vec3f p = inAxes(axes, v.position - sphere.center);
    const float r = std::hypot(p.x, p.y), cosPhi = r > 0 ? p.x / r : 1, sinPhi = r > 0 ? p.y / r : 0;
    return {r > 0 ? aroundAxis(axes, p.x, p.y) : axes[1], ((axes[0] * cosPhi + axes[1] * sinPhi) * p.z - axes[2] * r) * float(kPi)};
}
Tangents tangentsOf(const Disk& disk, const Vertex& v) {
    const float r = v.uv.length();
    if (!(r > 0)) return {disk.axisX, disk.axisY};
    return {(disk.axisX * v.uv.x + disk.axisY * v.uv.y) * (1 / r), (disk.axisY * v.uv.x - disk.axisX * v.uv.y) * float(2 * kPi)};
}
Tangents tangentsOf(const Cylinder& cylinder, const Vertex& v) {
    const Vec3f p = inAxes(cylinder.axes, v.position - cylinder.base);
    return {aroundAxis(cylinder.axes, p.x, p.y), cylinder.axes[2] * cylinder.length};
}

}  // namespace

void Mesh::prepare() {
    box.makeEmpty();
    for (const Vec3f& p : positions) box.extendBy(p);
    // It reads 16 bytes a vertex.
    positions.reserve(positions.size() + 1);
}

Vec3d MeshInstance::toWorldNormal(const Vec3d& n) const {
    // By the matrix of cofactors: of the inverse transpose without the division. The front stays the front in a mirror.
    const Vec3d x(toWorld[0]), y(toWorld[1]), z(toWorld[2]), yz = y.cross(z);
    const Vec3d image = yz * n.x + z.cross(x) * n.y + x.cross(y) * n.z;
    return x.dot(yz) > 0 ? image : -image;
}

void Shape::setNormals(Vertex& v) const {
    if (const Mesh* mesh = std::get_if<Mesh>(&geometry)) {
        v.normal = v.shadingNormal = mesh->faceNormals[v.primitive];
        if (mesh->normals.empty()) return;
        const Vec3f n = interpolatedNormal(*mesh, v);
        if (length2(n) > 0) v.shadingNormal = normalize(n);
    } else if (const MeshInstance* instance = std::get_if<MeshInstance>(&geometry)) {
        v.normal = v.shadingNormal = Vec3f(areaVector(*instance, v.primitive).normalized());
        if (instance->mesh->normals.empty()) return;
        const Vec3f n = interpolatedNormal(*instance->mesh, v);
        if (length2(n) > 0) v.shadingNormal = Vec3f(instance->toWorldNormal(Vec3d(n)).normalized());
    } else if (const Disk* disk = std::get_if<Disk>(&geometry)) {
        v.normal = v.shadingNormal = disk->normal;
    } else {
        const Sphere* sphere = std::get_if<Sphere>(&geometry);
        const Vec3f n = sphere ? outward(*sphere, v.position) : outward(std::get<Cylinder>(geometry), v.position);
        v.normal = v.shadingNormal = flipNormals ? -n : n;
    }
}

Vec2f Shape::texcoord(const Vertex& v) const {
    return std::visit([&](const auto& g) { return texcoordOf(g, v); }, geometry);
}

// Out of line: it is rarely needed, and makes what is needed at every vertex too large to be inlined.
[[gnu::noinline]] Tangents Shape::tangents(const Vertex& v) const {
    return std::visit([&](const auto& g) { return tangentsOf(g, v); }, geometry);
}

Vertex Shape::samplePoint(uint32_t shapeIndex, double u, double v) const {
    Vertex x{};
    x.kind = Vertex::Kind::Surface;
    x.lobe = Lobe::Smooth;
    x.shape = shapeIndex;
    const Mesh* mesh = std::get_if<Mesh>(&geometry);
    const MeshInstance* instance = std::get_if<MeshInstance>(&geometry);
    if (mesh || instance) {
        x.primitive = uint32_t(triangles.sample(u));
        x.uv = squareToTriangle(u, v);
        x.position = mesh ? mesh->point(x.primitive, x.uv) : instance->point(x.primitive, x.uv);
    } else if (const Sphere* sphere = std::get_if<Sphere>(&geometry)) {
        x.position = sphere->center + squareToSphere(u, v) * sphere->radius;
    } else if (const Disk* disk = std::get_if<Disk>(&geometry)) {
        x.uv = squareToDisc(u, v);
        x.position = disk->center + disk->axisX * x.uv.x + disk->axisY * x.uv.y;
    } else {
        const Cylinder& cylinder = std::get<Cylinder>(geometry);
        const double phi = 2 * kPi * u;
        const auto& [a, b, c] = cylinder.axes;
        x.position = cylinder.base + (a * float(std::cos(phi)) + b * float(std::sin(phi))) * cylinder.radius + c * float(v * cylinder.length);
    }
    setNormals(x);
    return x;
}

Sample2 Shape::invertPoint(const Vertex& v) const {
    if (const Sphere* sphere = std::get_if<Sphere>(&geometry)) return sphereToSquare(outward(*sphere, v.position));
    if (std::holds_alternative<Disk>(geometry)) return discToSquare(v.uv.x, v.uv.y);
    if (const Cylinder* cylinder = std::get_if<Cylinder>(&geometry)) {
        const Vec3f p = inAxes(cylinder->axes, v.position - cylinder->base);
        return {inverseAzimuth(p.x, p.y), std::clamp(double(p.z) / cylinder->length, 0.0, 1.0)};
    }
    const Sample2 s = triangleToSquare(v.uv);
    return {triangles.invert(v.primitive, s.u), s.v};
}

void Shape::prepare() {
    if (const Sphere* sphere = std::get_if<Sphere>(&geometry)) {
        area = 4 * kPi * sphere->radius * sphere->radius;
        return;
    }
    if (const Disk* disk = std::get_if<Disk>(&geometry)) {
        area = kPi * Vec3d(disk->axisX).cross(Vec3d(disk->axisY)).length();
        return;
    }
    if (const Cylinder* cylinder = std::get_if<Cylinder>(&geometry)) {
        area = 2 * kPi * cylinder->radius * cylinder->length;
        return;
    }
    Mesh* mesh = std::get_if<Mesh>(&geometry);
    const auto count = uint32_t(triangleMesh()->triangles.size());
    const auto vectorOf = [&](uint32_t i) { return mesh ? areaVector(*mesh, i) : areaVector(std::get<MeshInstance>(geometry), i); };
    if (mesh) {
        mesh->faceNormals.resize(count);
        for (uint32_t i = 0; i < count; ++i) mesh->faceNormals[i] = Vec3f(vectorOf(i).normalized());
    }
    if (emitter == kNone) return;
    std::vector<double> areas(count);
    area = 0;
    for (uint32_t i = 0; i < count; ++i) {
        areas[i] = vectorOf(i).length() / 2;
        area += areas[i];
    }
    triangles = DiscreteDistribution(areas);
}

const Mesh* Shape::triangleMesh() const {
    if (const MeshInstance* instance = std::get_if<MeshInstance>(&geometry)) return instance->mesh.get();
    return std::get_if<Mesh>(&geometry);
}

Imath::Box3f Shape::bounds() const {
    Imath::Box3f box;
    const auto around = [&box](const Vec3f& center, const Vec3f& reach) {
        box.extendBy(center - reach);
        box.extendBy(center + reach);
    };
    if (const Mesh* mesh = std::get_if<Mesh>(&geometry)) {
        return mesh->box;
    } else if (const MeshInstance* instance = std::get_if<MeshInstance>(&geometry)) {
        const Imath::Box3f& own = instance->mesh->box;
        for (int corner = 0; corner < 8; ++corner)
            box.extendBy(Vec3f(instance->toWorldPoint(
                {corner & 1 ? own.max.x : own.min.x, corner & 2 ? own.max.y : own.min.y, corner & 4 ? own.max.z : own.min.z})));
    } else if (const Sphere* sphere = std::get_if<Sphere>(&geometry)) {
        around(sphere->center, Vec3f(sphere->radius));
    } else if (const Disk* disk = std::get_if<Disk>(&geometry)) {
        const Vec3f &a = disk->axisX, &b = disk->axisY;
        around(disk->center, {std::hypot(a.x, b.x), std::hypot(a.y, b.y), std::hypot(a.z, b.z)});
    } else {
        const Cylinder& cylinder = std::get<Cylinder>(geometry);
        for (const float height : {0.0f, cylinder.length}) around(cylinder.base + cylinder.axes[2] * height, Vec3f(cylinder.radius));
    }
    return box;
}

}  // namespace ulam
