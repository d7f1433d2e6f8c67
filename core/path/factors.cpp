#include "core/path/factors.h"

namespace ulam {

Spectrum PathFactors::contribution() const {
    Spectrum f = at[0].f;
    double geometry = 1;
    for (int i = 1; i < size; ++i) {
        f *= at[i].f;
        geometry *= edge[i - 1].geometry();
    }
    return f * geometry;
}

bool evaluate(const Scene& scene, const Path& path, int first, int last, PathFactors& factors) {
    for (int i = first; i < last; ++i) {
        factors.edge[i] = Edge(path[i], path[i + 1]);
        if (!(factors.edge[i].geometry() > 0)) {
            const Vec3f sum = path[i].position + path[i + 1].position;
            checkFinite(Cause::Geometry, sum.x + sum.y + sum.z);
            return false;
        }
    }
    const int k = path.length();
    if (k == 1 && !showsItself(path[0])) return false;
    for (int i = first; i <= last; ++i) {
        Scattering& at = factors.at[i];
        if (i == 0) {
            const Emission e = emission(scene, path[0], factors.edge[0].direction);
            at = {e.radiance, e.pdf, 0};
        } else if (i == k) {
            const Perspective::Response response = scene.sensor->respond(path[k], -factors.edge[k - 1].direction);
            at = {Spectrum(response.importance), 0, response.pdf};
        } else {
            if (!path[i].onSurface()) return false;
            at = scatter(scene, path[i], path[i].lobe, -factors.edge[i - 1].direction, factors.edge[i].direction);
        }
        if (isBlack(at.f)) return false;
    }
    return true;
}

PathDensities densities(const Scene& scene, const PathLimits& limits, const Path& path, const PathFactors& factors) {
    PathDensities d;
    const int k = path.length();
    d.size = k + 1;
    std::array<double, kMaxVertices> albedo;
    for (int i = 0; i <= k; ++i) {
        const bool inner = i > 0 && i < k;
        d.delta[i] = isDelta(path[i].lobe);
        albedo[i] = inner ? albedoAt(scene, path[i]) : 1;
    }
    for (int i = 1; i <= k; ++i)
        d.fromLight[i] = factors.fromLight(i) * (i > 1 ? limits.continuation(i - 1, albedo[i - 1]) : 1);
    for (int i = 0; i < k; ++i)
        d.fromCamera[i] = factors.fromCamera(i) * (i < k - 1 ? limits.continuation(k - i - 1, albedo[i + 1]) : 1);
    d.fromLight[0] = emissionPositionPdf(scene, path[0]);
    d.fromCamera[k] = scene.sensor->positionPdf(path[k]);
    d.directLight = directLightPdf(scene, path[1], path[0]);
    d.directCamera = d.fromCamera[k];
    d.lightHittable = hittable(path[0]);
    return d;
}

}  // namespace ulam
