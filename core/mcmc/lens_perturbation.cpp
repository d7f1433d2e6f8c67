#include "core/mcmc/lens_perturbation.h"

namespace ulam {

int LensPerturbation::end(const Path& x, int& turns) {
    turns = 0;
    for (int m = x.length() - 1; m > 0; --m) {
        if (isDelta(x[m].lobe)) continue;
        if (!isDelta(x[m - 1].lobe)) return m;
        ++turns;
    }
    return hittable(x.light()) ? 0 : -1;
}

Proposal LensPerturbation::propose(const Sample& x, int m, StepContext& context) const {
    Proposal p;
    const Scene& scene = context.scene();
    const int k = x.path.length();
    const Perspective& sensor = *scene.sensor;
    const Block u = context.random.nextBlock();
    const Vec2f raster = raster_.sample(x.splats[0].raster, u);
    if (!sensor.contains(raster)) {
        p.reject = Reject::OffScreen;
        return p;
    }
    Vertex lens;
    if (!AperturePerturbation::sample(sensor, x.path.camera(), u, lens)) {
        p.reject = Reject::OffScreen;
        return p;
    }

    PathEdit edit(x, m - 1, k + 1, k - m + 2, context, p.y);
    edit.takeFromCamera(lens);
    if ((p.reject = edit.growFromCameraAlong(sensor.direction(lens, raster))) != Reject::None) return p;
    for (int i = k - 1; i > m; --i) {
        if (isDelta(x.path[i].lobe)) {
            p.reject = edit.followFromCamera(x.path[i].lobe);
        } else {
            const Vec3f w = context.tracing.directionOfRay(x.path[i], x.path[i - 1]);
            p.y.path[i].lobe = Lobe::Smooth;
            p.reject = edit.growFromCameraAlong(direction_.sample(w, context.random.nextBlock()));
        }
        if (p.reject != Reject::None) return p;
    }
    if ((p.reject = edit.join()) != Reject::None) return p;
    const auto atX = response(scene, x), atY = response(scene, p.y);
    p.logForward = logDensity(context.tracing, x, atX, p.y, atY, m);
    p.logReverse = logDensity(context.tracing, p.y, atY, x, atX, m);
    rejectIfRoundedAway(p);
    return p;
}

Perspective::Response LensPerturbation::response(const Scene& scene, const Sample& s) {
    return scene.sensor->respond(s.path.camera(), -s.factors.edge[s.path.length() - 1].direction);
}

double LensPerturbation::logDensity(const Tracing& tracing, const Sample& from, const Sample& to, int m) const {
    return logDensity(tracing, from, response(tracing.scene(), from), to, response(tracing.scene(), to), m);
}

double LensPerturbation::logDensity(const Tracing& tracing, const Sample& from, const Perspective::Response& a, const Sample& to,
                                    const Perspective::Response& b, int m) const {
    const int k = to.path.length();
    const Scene& scene = tracing.scene();
    const Perspective& sensor = *scene.sensor;
    if (!(a.pdf > 0 && b.pdf > 0)) return -std::numeric_limits<double>::infinity();
    // fromCamera(k−1) is the density of a uniform raster position, 1 / window area per pixel².
    double sum = std::log(raster_.pdf(a.raster, b.raster) * sensor.windowArea() * to.factors.fromCamera(k - 1) *
                          AperturePerturbation::pdf(sensor, from.path.camera(), to.path.camera()));
    for (int i = k - 2; i >= m; --i) {
        if (isDelta(to.path[i + 1].lobe)) {
            sum += logFollowedFromCamera(scene, to.path, to.factors, i);
        } else {
            const double pdf = direction_.pdf(tracing.directionOfRay(from.path[i + 1], from.path[i]), tracing.directionOfRay(to.path[i + 1], to.path[i]));
            sum += std::log(to.factors.edge[i].toAreaA(pdf));
        }
    }
    return sum;
}

}  // namespace ulam
