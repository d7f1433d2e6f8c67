#include "core/path/primary_map.h"

#include "core/path/densities.h"

namespace ulam {

bool makePath(Tracing& tracing, const PathLimits& limits, Technique technique, PrimaryVector& u, Random& random, Path& path) {
    const Scene& scene = tracing.scene();
    const auto [s, t] = technique;
    Numbers numbers(u, random);
    Subpath light, camera;
    const Vec2f raster = scene.sensor->sampleRaster(numbers(NumberStream::Camera, 0));
    walkFromCamera(tracing, limits, t, raster, numbers, camera);
    if (camera.size < t) return false;
    if (s == 1 && t >= 2) sampleDirectLight(scene, camera.vertex[t - 1], numbers(NumberStream::Connect, t - 2), light);
    else walkFromLight(tracing, limits, s, numbers, light);
    if (light.size < s) return false;
    path.resize(s + t);
    for (int i = 0; i < s; ++i) path[i] = light.vertex[i];
    for (int j = 0; j < t; ++j) path[s + t - 1 - j] = camera.vertex[j];
    if (s > 0) path[s - 1].lobe = Lobe::Smooth;
    path[s].lobe = Lobe::Smooth;
    if (s == 0) return scene.emitterAt(path[0]) != kNone;
    if (!path[s].onSurface() && t > 1) return false;
    return Edge(path[s - 1], path[s]).geometry() > 0 && tracing.visible(path[s - 1], path[s]);
}

namespace {

/// One uniform number of which the path only says that it lies below q.
double below(double q, Random& random) { return q * random(); }

class Inversion {
public:
    Inversion(const Tracing& tracing, const PathLimits& limits, const Path& path, Random& random, PrimaryVector& u)
        : tracing_(tracing), scene_(tracing.scene()), limits_(limits), path_(path), random_(random), u_(u) {}

    bool lightWalk(int s) {
        if (s < 1) return true;
        u_.append(NumberStream::Light, emitterNumbers());
        if (s < 2) return true;
        Block block = random_.nextBlock();
        const uint32_t e = scene_.emitterAt(path_[0]);
        Vertex origin = path_[0];
        if (origin.onSurface()) origin.position = tracing_.rayOrigin(origin, path_[1].position - origin.position);
        dispatch(scene_.emitters[e], [&](const auto& emitter) { emitter.invertDirection(scene_.emission(e), origin, path_[1], block); });
        u_.append(NumberStream::Light, block);
        for (int i = 1; i + 1 < s; ++i)
            if (!scattering(NumberStream::Light, i, i - 1, i + 1, i)) return false;
        return true;
    }

    bool cameraWalk(int t) {
        const int k = path_.length();
        Block block = random_.nextBlock();
        scene_.sensor->invertPosition(path_[k], block);
        if (t >= 2) {
            const auto response = scene_.sensor->respond(path_[k], directionTo(path_[k], path_[k - 1]));
            if (!(response.pdf > 0)) return false;
            scene_.sensor->invertRaster(response.raster, block);
        }
        u_.append(NumberStream::Camera, block);
        for (int j = 1; j + 1 < t; ++j)
            if (!scattering(NumberStream::Camera, k - j, k - j + 1, k - j - 1, j)) return false;
        return true;
    }

    bool nextEvent(int t) {
        while (u_.size(NumberStream::Connect) < t - 2) u_.append(NumberStream::Connect, random_.nextBlock());
        u_.append(NumberStream::Connect, emitterNumbers());
        return true;
    }

private:
    Block emitterNumbers() {
        Block block = random_.nextBlock();
        const uint32_t e = scene_.emitterAt(path_[0]);
        block[0] = scene_.emitterChoice().invert(e, block[0]);
        dispatch(scene_.emitters[e], [&](const auto& emitter) { emitter.invertPosition(scene_.emission(e), path_[0], block); });
        return block;
    }

    bool scattering(NumberStream stream, int vertex, int previous, int next, int index) {
        Block block = random_.nextBlock();
        const Vertex& v = path_[vertex];
        if (!v.onSurface()) return false;
        if (!invertScattering(scene_, v, directionTo(v, path_[previous]), tracing_.directionOfRay(v, path_[next]), block)) return false;
        block[3] = below(limits_.continuation(index, albedoAt(scene_, v)), random_);
        u_.append(stream, block);
        return true;
    }

    const Tracing& tracing_;
    const Scene& scene_;
    const PathLimits& limits_;
    const Path& path_;
    Random& random_;
    PrimaryVector& u_;
};

}  // namespace

bool invertPath(const Tracing& tracing, const PathLimits& limits, Technique technique, const Path& path, Random& random, PrimaryVector& u) {
    u.clear();
    const auto [s, t] = technique;
    if (s > 0 && tracing.scene().emitterAt(path[0]) == kNone) return false;
    Inversion inversion(tracing, limits, path, random, u);
    if (!inversion.cameraWalk(t)) return false;
    return s == 1 && t >= 2 ? inversion.nextEvent(t) : inversion.lightWalk(s);
}

}  // namespace ulam
