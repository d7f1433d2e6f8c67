#include "core/path/walk.h"

namespace ulam {
namespace {

/// Takes the vertex in slot `size` into the walk. pdfW: density of the direction that led to it, Russian roulette included.
void arrive(const Scene& scene, const PathLimits& limits, Subpath& p, const Spectrum& throughput, double pdfW) {
    const int i = p.size++;
    p.back[i] = Edge(p.vertex[i], p.vertex[i - 1]);
    p.throughput[i] = throughput;
    p.forward[i] = p.back[i].toAreaA(pdfW);
    p.backward[i] = 0;
    p.albedo[i] = limits.hasRoulette() && p.vertex[i].onSurface() ? albedoAt(scene, p.vertex[i]) : 1;
}

}  // namespace

bool extendWalk(Tracing& tracing, const PathLimits& limits, From from, const Block& numbers, Subpath& p) {
    const int i = p.size - 1;
    Vertex& v = p.vertex[i];
    if (!v.onSurface()) return false;
    const double q = limits.continuation(i, p.albedo[i]);
    if (!(numbers[3] < q)) return false;
    const Edge& back = p.back[i];
    ScatteredDirection s;
    const bool scattered = sampleScattering(tracing.scene(), v, back.direction, from, numbers, s);
    const double pdf = scattered ? s.scattering.pdf(from) : 0;
    if (!(pdf > 0) || !tracing.next(v, s.direction, p.vertex[i + 1])) {
        v.lobe = Lobe::Smooth;
        return false;
    }
    if (from == From::Light && !p.vertex[i + 1].onSurface()) {  // light that leaves the scene
        v.lobe = Lobe::Smooth;
        return false;
    }
    p.backward[i - 1] = back.toAreaB(s.scattering.reversePdf(from));
    const Spectrum throughput = p.throughput[i] * s.scattering.f * (cosine(v, s.direction) / (pdf * q));
    arrive(tracing.scene(), limits, p, throughput, pdf * q);
    return true;
}

void walkFromLight(Tracing& tracing, const PathLimits& limits, int vertices, Numbers& numbers, Subpath& p) {
    p.size = 0;
    if (vertices < 1) return;
    const Scene& scene = tracing.scene();
    Block u = numbers(NumberStream::Light, 0);
    const uint32_t e = uint32_t(scene.emitterChoice().sample(u[0]));
    const EmissionContext context = scene.emission(e);
    EmittedRay ray;
    dispatch(scene.emitters[e], [&](const auto& emitter) {
        p.vertex[0] = emitter.samplePosition(context, u);
        p.forward[0] = scene.emitterChoice().probability(e) * emitter.positionPdf(context, p.vertex[0]);
        p.throughput[0] = Spectrum(1 / p.forward[0]);
        p.backward[0] = p.albedo[0] = 0;
        p.size = 1;
        if (vertices > 1) ray = emitter.sampleDirection(context, p.vertex[0], numbers(NumberStream::Light, 1));
    });
    if (!checkFinite(Cause::Light, p.forward[0])) p.size = 0;
    if (p.size == 0 || vertices < 2) return;
    const Emission e0 = emission(scene, p.vertex[0], ray.direction);
    if (!(ray.pdf > 0) || !checkFinite(Cause::Light, ray.pdf + ray.direction.x + ray.direction.y + ray.direction.z) || isBlack(e0.radiance)) return;
    const bool hit = p.vertex[0].atInfinity() ? tracing.nextFrom(ray.origin, ray.direction, p.vertex[1])
                                            : tracing.next(p.vertex[0], ray.direction, p.vertex[1]);
    if (!hit || !p.vertex[1].onSurface()) return;
    p.direct = directLightPdf(scene, p.vertex[1], p.vertex[0]);
    arrive(scene, limits, p, p.throughput[0] * e0.radiance * (cosine(p.vertex[0], ray.direction) / ray.pdf), ray.pdf);
    while (p.size < vertices && extendWalk(tracing, limits, From::Light, numbers(NumberStream::Light, p.size), p)) {}
}

void walkFromCamera(Tracing& tracing, const PathLimits& limits, int vertices, const Vec2f& raster, Numbers& numbers, Subpath& p) {
    const Scene& scene = tracing.scene();
    const Perspective& sensor = *scene.sensor;
    p.vertex[0] = sensor.samplePosition(numbers(NumberStream::Camera, 0));
    p.forward[0] = sensor.positionPdf(p.vertex[0]);
    p.throughput[0] = Spectrum(1 / p.forward[0]);
    p.backward[0] = p.albedo[0] = 0;
    p.size = 1;
    if (vertices < 2) return;
    const Vec3f w = sensor.direction(p.vertex[0], raster);
    const Perspective::Response response = sensor.respond(p.vertex[0], w);
    if (!(response.pdf > 0) || !tracing.next(p.vertex[0], w, p.vertex[1])) return;
    arrive(scene, limits, p, p.throughput[0] * (response.importance * cosine(p.vertex[0], w) / response.pdf), response.pdf);
    while (p.size < vertices && extendWalk(tracing, limits, From::Camera, numbers(NumberStream::Camera, p.size - 1), p)) {}
}

}  // namespace ulam
