#include "core/scene/scene.h"

#include "core/base/error.h"

#include <Imath/ImathBox.h>

namespace ulam {

void Scene::finalize() {
    Imath::Box3f box;
    for (Shape& shape : shapes) {
        shape.prepare();
        if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry)) {
            for (const Vec3f& p : mesh->positions) box.extendBy(p);
        } else {
            const Sphere& sphere = std::get<Sphere>(shape.geometry);
            box.extendBy(sphere.center - Vec3f(sphere.radius));
            box.extendBy(sphere.center + Vec3f(sphere.radius));
        }
    }
    if (!box.isEmpty()) bounds_ = {box.center(), std::max(1e-6f, length(box.size()) / 2) * 1.0001f};

    std::vector<double> powers;
    for (uint32_t i = 0; i < emitters.size(); ++i) {
        powers.push_back(dispatch(emitters[i], [&](const auto& e) { return e.power(emission(i)); }));
        if (std::holds_alternative<ConstantEmitter>(emitters[i])) environment = i;
    }
    double total = 0;
    for (double p : powers) total += p;
    if (!(total > 0)) fail(ExitCode::InvalidConfig, "the scene has no light: add an emitter with positive radiance or intensity");
    emitterChoice_ = DiscreteDistribution(powers);
    rays_ = RayTracer(shapes);
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
        const auto& t = mesh->triangles[hit.primitive];
        const Vec3f &a = mesh->positions[t[0]], &b = mesh->positions[t[1]], &c = mesh->positions[t[2]];
        v.position = a + (b - a) * hit.uv.x + (c - a) * hit.uv.y;
    } else {
        const Sphere& sphere = std::get<Sphere>(shape.geometry);
        const Vec3f outward = normalize(origin + direction * hit.distance - sphere.center);
        v.position = sphere.center + outward * sphere.radius;
    }
    shape.setNormals(v);
}

}  // namespace ulam
