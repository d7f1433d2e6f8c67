#include "core/scene/scene.h"

#include <set>

#include "core/base/error.h"

namespace ulam {

void Scene::finalize() {
    Imath::Box3f box;
    for (const Shape& shape : shapes) box.extendBy(shape.bounds());
    if (!box.isEmpty()) bounds_ = {box.center(), std::max(1e-6f, length(box.size()) / 2) * 1.0001f};

    // First, since building takes more memory for a while than what follows.
    MemoryNeeds held = memory(Tree::Building);
    const MemoryNeed tree = held.back();
    held.pop_back();
    requireMemory("the scene", held, {tree});
    rays_ = RayTracer(shapes);
    for (Shape& shape : shapes) shape.prepare();

    for (Emitter& emitter : emitters)
        if (auto* area = std::get_if<AreaEmitter>(&emitter); area && area->texture != kNone) area->emitted = meanRadiance(*area);
    std::vector<double> powers;
    for (uint32_t i = 0; i < emitters.size(); ++i) {
        powers.push_back(dispatch(emitters[i], [&](const auto& e) { return e.power(emission(i)); }));
        if (isEnvironment(emitters[i])) environment = i;
    }
    double total = 0;
    for (double p : powers) total += p;
    if (!(total > 0)) fail(ExitCode::InvalidConfig, "the scene has no light: add an emitter with positive radiance or intensity");
    emitterChoice_ = DiscreteDistribution(powers);
}

MemoryNeeds Scene::memory(Tree tree) const {
    double triangles = 0, geometry = double(shapes.capacity() * sizeof(Shape) + materials.size() * sizeof(Material));
    std::set<const Mesh*> counted;  // instances share meshes
    for (const Shape& shape : shapes) {
        if (shape.id.size() > 15) geometry += double(shape.id.capacity());  // not in the string itself
        if (shape.triangles.size() > 0) geometry += double(shape.triangles.size() * sizeof(double));
        const Mesh* mesh = shape.triangleMesh();
        if (!mesh || !counted.insert(mesh).second) continue;
        triangles += double(mesh->triangles.size());
        geometry += double((mesh->positions.size() + mesh->normals.size() + mesh->faceNormals.size()) * sizeof(Vec3f) +
                           mesh->texcoords.size() * sizeof(Vec2f) + mesh->triangles.size() * sizeof(mesh->triangles[0]));
    }
    double pictures = 0;
    for (const Texture& texture : textures)
        if (const auto* bitmap = std::get_if<BitmapTexture>(&texture)) pictures += double(bitmap->bytes());
    for (const Emitter& emitter : emitters)
        if (const auto* sky = std::get_if<EnvmapEmitter>(&emitter)) pictures += double(sky->map->bytes());
    const TreeMemory rays = treeMemory(shapes);
    const bool building = tree == Tree::Building;
    return {{fmt::format("{} triangles and {} shapes", triangles, shapes.size()), geometry, "coarser meshes or fewer instances"},
            {"pictures of textures and the environment", pictures, "smaller pictures"},
            {building ? "the tree for tracing rays while it is built" : "the tree for tracing rays", building ? rays.building : rays.built,
             "coarser meshes or fewer instances"}};
}

Spectrum Scene::meanRadiance(const AreaEmitter& area) const {
    // Points of a lattice over the numbers that make uniform points: fine enough to choose lights by.
    constexpr int kSide = 64;
    Spectrum sum(0.0);
    const Shape& shape = shapes[area.shape];
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            const Vertex v = shape.samplePoint(area.shape, (i + 0.5) / kSide, (j + 0.5) / kSide);
            sum += textureColor(textures[area.texture], shape.texcoord(v)) / (kSide * kSide);
        }
    return sum;
}

void Scene::vertexAt(const Vec3f& origin, const Vec3f& direction, const Hit& hit, Vertex& v) const {
    v.kind = Vertex::Kind::Surface;
    v.lobe = Lobe::Smooth;
    v.shape = hit.shape;
    v.primitive = hit.primitive;
    v.uv = hit.uv;
    const Shape& shape = shapes[hit.shape];
    if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry)) {
        // From the triangle rather than the ray: the error then does not grow with the ray's length.
        v.position = mesh->point(hit.primitive, hit.uv);
    } else if (const MeshInstance* instance = std::get_if<MeshInstance>(&shape.geometry)) {
        v.position = instance->point(hit.primitive, hit.uv);
    } else if (const Sphere* sphere = std::get_if<Sphere>(&shape.geometry)) {
        const Vec3f outward = normalize(origin + direction * hit.distance - sphere->center);
        v.position = sphere->center + outward * sphere->radius;
    } else if (const Disk* disk = std::get_if<Disk>(&shape.geometry)) {
        v.position = disk->center + disk->axisX * hit.uv.x + disk->axisY * hit.uv.y;
    } else {
        const Cylinder& cylinder = std::get<Cylinder>(shape.geometry);
        const Vec3f d = origin + direction * hit.distance - cylinder.base;
        const Vec3f up = cylinder.axes[2] * dot(d, cylinder.axes[2]);
        v.position = cylinder.base + up + normalize(d - up) * cylinder.radius;
    }
    shape.setNormals(v);
}

}  // namespace ulam
