#pragma once
// Generated scenes in tests.

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/scene/load.h"
#include "tests/support/catch.h"

namespace ulam {

inline SceneDescription describeGenerator(const Json& generator) {
    return SceneDescription::fromNode(JsonNode(generator), "/nonexistent");
}

/// A film of n × n pixels.
inline FilmSize square(int n) {
    return {n, n, 0, 0, n, n};
}

inline Vertex firstHit(const Scene& scene, const Vec3f& origin, const Vec3f& direction) {
    Hit hit{};
    REQUIRE(scene.rays().intersect(origin, direction, hit));
    Vertex v;
    scene.vertexAt(origin, direction, hit, v);
    return v;
}

inline uint32_t shapeNamed(const Scene& scene, const std::string& id) {
    for (uint32_t i = 0; i < scene.shapes.size(); ++i)
        if (scene.shapes[i].id == id) return i;
    FAIL("no shape " << id);
    return kNone;
}

/// Mean and its standard error.
struct Estimate {
    double mean, error;
};

/// Direct light of one area light on what the camera sees in a part of the raster, by brute force: uniform points of
/// the raster and of the light. What is seen must be diffuse.
inline Estimate directLight(const Scene& scene, const Vec2f& rasterMin, const Vec2f& rasterMax,
                            const std::string& lightName, int samples, uint32_t seed) {
    Random random({21, seed}, 0, 0);
    const uint32_t lightIndex = shapeNamed(scene, lightName);
    const Shape& light = scene.shapes[lightIndex];
    const double emitted = std::get<AreaEmitter>(scene.emitters[light.emitter]).emitted.x;
    const Vec3f eye = scene.sensor->samplePosition({}).position;
    double sum = 0, sum2 = 0;
    for (int i = 0; i < samples; ++i) {
        const Vec2f raster(float(rasterMin.x + random() * (rasterMax.x - rasterMin.x)),
                           float(rasterMin.y + random() * (rasterMax.y - rasterMin.y)));
        const Vertex seen = firstHit(scene, eye, scene.sensor->direction(scene.sensor->samplePosition({}), raster));
        const Vertex lit = light.samplePoint(lightIndex, random(), random());
        const Vec3d segment = Vec3d(lit.position) - Vec3d(seen.position);
        const double d2 = segment.dot(segment),
                     cosines = Vec3d(seen.normal).dot(segment) * -Vec3d(lit.normal).dot(segment) / d2;
        // From a little inside the segment: its ends lie on surfaces.
        if (cosines <= 0 ||
            scene.rays().occluded(Vec3f(Vec3d(seen.position) + segment * 1e-4), Vec3f(segment * (1 - 2e-4))))
            continue;
        const double albedo = std::get<Diffuse>(scene.materialAt(seen).front.bsdf()).reflectance.x;
        const double f = albedo / kPi * emitted * cosines / d2 * light.area;
        sum += f, sum2 += f * f;
    }
    const double mean = sum / samples;
    return {mean, std::sqrt(std::max(0.0, sum2 / samples - mean * mean) / samples)};
}

inline double meanOf(const Image& image) {
    double sum = 0;
    for (const Rgb& pixel : image.pixels) sum += pixel.x;
    return sum / double(image.pixels.size());
}

}  // namespace ulam
