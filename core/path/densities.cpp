#include "core/path/densities.h"

#include <limits>

namespace ulam {

double PathDensities::log(int s) const {
    if (!possible(s)) return -std::numeric_limits<double>::infinity();
    double sum = std::log(direct(s));
    for (int i = 0; i < s; ++i) sum += std::log(fromLight[i]);
    for (int i = s; i < size; ++i) sum += std::log(fromCamera[i]);
    return sum;
}

double PathDensities::weight(int s, const TechniqueSet& set, Heuristic heuristic) const {
    const auto term = [heuristic](double ratio) { return heuristic == Heuristic::Balance ? ratio : ratio * ratio; };
    const int last = set.walkFromLight() ? size - 1 : 1;
    // Two neighbouring techniques differ in the end that makes one vertex. All divisions at once: they do not depend on
    // each other.
    std::array<double, kMaxVertices> step;
    for (int i = 0; i < s; ++i) step[i] = fromCamera[i] / fromLight[i];
    for (int i = s; i < last; ++i) step[i] = fromLight[i] / fromCamera[i];

    const double inverseOwn = 1 / direct(s);
    double sum = 1, ratio = inverseOwn;  // p_i / p_s, but for what is direct in technique i
    for (int i = s - 1; i >= 0; --i) {
        ratio *= step[i];
        if (possible(i) && set.contains(i, size - i)) sum += term(ratio * direct(i));
    }
    ratio = inverseOwn;
    for (int i = s + 1; i <= last; ++i) {
        ratio *= step[i - 1];
        if (possible(i) && set.contains(i, size - i)) sum += term(ratio * direct(i));
    }
    return 1 / sum;
}

namespace {

/// Copies what the two walks know; the entries around the connection are the caller's.
void gather(const PathLimits& limits, const Subpath& light, int s, const Subpath& camera, int t, PathDensities& d) {
    const int k = s + t - 1;
    d.size = k + 1;
    for (int i = 0; i < s; ++i) {
        d.fromLight[i] = light.forward[i];
        d.delta[i] = i + 1 < s && isDelta(light.vertex[i].lobe);
        if (i + 2 < s) d.fromCamera[i] = light.backward[i] * limits.continuation(k - i - 1, light.albedo[i + 1]);
    }
    for (int j = 0; j < t; ++j) {
        const int i = k - j;
        d.fromCamera[i] = camera.forward[j];
        d.delta[i] = j + 1 < t && isDelta(camera.vertex[j].lobe);
        if (j + 2 < t) d.fromLight[i] = camera.backward[j] * limits.continuation(i - 1, camera.albedo[j + 1]);
    }
    d.directCamera = camera.forward[0];
}

}  // namespace

bool connect(Tracing& tracing, const PathLimits& limits, const Subpath& light, int s, const Subpath& camera, int t, Connection& out) {
    const Scene& scene = tracing.scene();
    const Vertex &y = light.vertex[s - 1], &z = camera.vertex[t - 1];
    if (!z.onSurface() && t > 1) return false;
    if (s == 1 && t == 1 && !showsItself(y)) return false;
    const Edge edge(y, z);
    if (!(edge.geometry() > 0)) return false;

    Scattering atY = Scattering::none(), atZ = Scattering::none();
    const Edge &beforeY = s > 1 ? light.back[s - 1] : edge, &afterZ = t > 1 ? camera.back[t - 1] : edge;
    if (s == 1) {
        const Emission e = emission(scene, y, edge.direction);
        atY.f = e.radiance;
        atY.pdfToCamera = e.pdf;
    } else {
        atY = scatter(scene, y, Lobe::Smooth, beforeY.direction, edge.direction);
    }
    if (isBlack(atY.f)) return false;
    if (t == 1) {
        const Perspective::Response response = scene.sensor->respond(z, -edge.direction);
        out.raster = response.raster;
        atZ.f = Spectrum(response.importance);
        atZ.pdfToLight = response.pdf;
    } else {
        atZ = scatter(scene, z, Lobe::Smooth, -edge.direction, afterZ.direction);
    }
    if (isBlack(atZ.f)) return false;
    if (!tracing.visible(y, z)) return false;

    out.contribution = light.throughput[s - 1] * atY.f * atZ.f * camera.throughput[t - 1] * edge.geometry();

    PathDensities& d = out.densities;
    gather(limits, light, s, camera, t, d);
    d.fromLight[s] = edge.toAreaB(atY.pdfToCamera) * (s > 1 ? limits.continuation(s - 1, light.albedo[s - 1]) : 1);
    d.fromCamera[s - 1] = edge.toAreaA(atZ.pdfToLight) * (t > 1 ? limits.continuation(t - 1, camera.albedo[t - 1]) : 1);
    if (t > 1) d.fromLight[s + 1] = afterZ.toAreaB(atZ.pdfToCamera) * limits.continuation(s, camera.albedo[t - 1]);
    if (s > 1) d.fromCamera[s - 2] = beforeY.toAreaB(atY.pdfToLight) * limits.continuation(t, light.albedo[s - 1]);
    d.lightHittable = hittable(light.vertex[0]);
    if (s == 1) {
        d.directLight = light.forward[0];
        d.fromLight[0] = emissionPositionPdf(scene, light.vertex[0]);
    } else {
        d.directLight = light.direct;
    }
    return true;
}

bool hitLight(Tracing& tracing, const PathLimits& limits, const Subpath& camera, int t, Connection& out) {
    const Scene& scene = tracing.scene();
    const Vertex& x0 = camera.vertex[t - 1];
    if (t < 2 || scene.emitterAt(x0) == kNone) return false;
    const Edge& edge = camera.back[t - 1];
    const Emission e = emission(scene, x0, edge.direction);
    if (isBlack(e.radiance)) return false;
    out.contribution = camera.throughput[t - 1] * e.radiance;

    PathDensities& d = out.densities;
    gather(limits, camera, 0, camera, t, d);
    d.fromLight[0] = emissionPositionPdf(scene, x0);
    d.fromLight[1] = edge.toAreaB(e.pdf);
    d.lightHittable = true;
    d.directLight = directLightPdf(scene, camera.vertex[t - 2], x0);
    return true;
}

void sampleDirectLight(const Scene& scene, const Vertex& from, const Block& numbers, Subpath& light) {
    Block u = numbers;
    const uint32_t e = uint32_t(scene.emitterChoice().sample(u[0]));
    const EmissionContext context = scene.emission(e);
    dispatch(scene.emitters[e], [&](const auto& emitter) {
        light.vertex[0] = emitter.sampleDirect(context, from, u);
        light.forward[0] = scene.emitterChoice().probability(e) * emitter.directPdf(context, from, light.vertex[0]);
    });
    if (!checkFinite(Cause::Light, light.forward[0])) light.forward[0] = 0;
    light.throughput[0] = Spectrum(1 / light.forward[0]);
    light.backward[0] = light.albedo[0] = 0;
    light.size = 1;
}

}  // namespace ulam
