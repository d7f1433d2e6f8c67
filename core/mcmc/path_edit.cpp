#include "core/mcmc/path_edit.h"

namespace ulam {

PathEdit::PathEdit(const Sample& x, int l, int m, int added, StepContext& context, Sample& y)
    : context_(context), y_(y), l_(l), m_(l + added), front_(l + 1), back_(l + added - 1) {
    const int k = x.path.length(), shift = m_ - m, length = k + shift;
    y.path.resize(length + 1);
    y.factors.size = length + 1;
    for (int i = 0; i <= l; ++i) y.path[i] = x.path[i];
    for (int i = m; i <= k; ++i) y.path[i + shift] = x.path[i];
    // Factors at x_l and x_m change with their neighbours; edges end where the range begins.
    if (l > 0) y.factors.copy(x.factors, 0, l, 0);
    if (m <= k) y.factors.copy(x.factors, m, k + 1, m_);
}

Reject PathEdit::growFromLight(const Block& numbers, bool direct) {
    const Scene& scene = context_.scene();
    const int i = front_++;
    Path& path = y_.path;
    if (i == 0) {
        Block u = numbers;
        const uint32_t e = uint32_t(scene.emitterChoice().sample(u[0]));
        dispatch(scene.emitters[e], [&](const auto& emitter) {
            path[0] = direct ? emitter.sampleDirect(scene.emission(e), path[1], u) : emitter.samplePosition(scene.emission(e), u);
        });
        return Reject::None;
    }
    Vertex& from = path[i - 1];
    if (i == 1) {
        const uint32_t e = scene.emitterAt(from);
        if (e == kNone) return Reject::ZeroTarget;
        const EmittedRay ray = dispatch(scene.emitters[e], [&](const auto& emitter) { return emitter.sampleDirection(scene.emission(e), from, numbers); });
        if (!(ray.pdf > 0)) return Reject::ZeroTarget;
        const bool hit = from.atInfinity() ? context_.tracing.nextFrom(ray.origin, ray.direction, path[1])
                                                             : context_.tracing.next(from, ray.direction, path[1]);
        return hit && path[1].onSurface() ? Reject::None : Reject::Missed;
    }
    if (!from.onSurface()) return Reject::ZeroTarget;
    ScatteredDirection s;
    if (!sampleScattering(scene, from, directionTo(from, path[i - 2]), From::Light, numbers, s)) return Reject::ZeroTarget;
    return context_.tracing.next(from, s.direction, path[i]) && path[i].onSurface() ? Reject::None : Reject::Missed;
}

Reject PathEdit::growFromLightAlong(const Vec3f& direction) {
    const int i = front_++;
    return context_.tracing.next(y_.path[i - 1], direction, y_.path[i]) && y_.path[i].onSurface() ? Reject::None : Reject::Missed;
}

Reject PathEdit::growFromCamera(const Block& numbers) {
    const Scene& scene = context_.scene();
    const int i = back_, k = y_.path.length();
    Path& path = y_.path;
    if (i == k) {
        --back_;
        path[k] = scene.sensor->samplePosition(numbers);
        return Reject::None;
    }
    if (i == k - 1) return growFromCameraAlong(scene.sensor->direction(path[k], scene.sensor->sampleRaster(numbers)));
    Vertex& from = path[i + 1];
    if (!from.onSurface()) return Reject::ZeroTarget;
    ScatteredDirection s;
    if (!sampleScattering(scene, from, directionTo(from, path[i + 2]), From::Camera, numbers, s)) return Reject::ZeroTarget;
    return growFromCameraAlong(s.direction);
}

Reject PathEdit::growFromCameraAlong(const Vec3f& direction) {
    const int i = back_--;
    Vertex& v = y_.path[i];
    if (!context_.tracing.next(y_.path[i + 1], direction, v)) return Reject::Missed;
    // Only x_0 may lie at infinity.
    return v.onSurface() || i == 0 ? Reject::None : Reject::Missed;
}

Reject PathEdit::followFromCamera(Lobe lobe) {
    Vertex& from = y_.path[back_ + 1];
    ScatteredDirection s;
    if (!from.onSurface() ||
        !sampleScattering(context_.scene(), from, directionTo(from, y_.path[back_ + 2]), From::Camera, Block{}, s, lobe))
        return Reject::ZeroTarget;
    return growFromCameraAlong(s.direction);
}

Reject PathEdit::followFromLight(Lobe lobe) {
    Vertex& from = y_.path[front_ - 1];
    ScatteredDirection s;
    if (!from.onSurface() ||
        !sampleScattering(context_.scene(), from, directionTo(from, y_.path[front_ - 2]), From::Light, Block{}, s, lobe))
        return Reject::ZeroTarget;
    return growFromLightAlong(s.direction);
}

Reject PathEdit::join() {
    Path& path = y_.path;
    const int a = back_, b = back_ + 1;  // the missing edge: everything up to a comes from the light's side
    // The ends of the joining edge scatter smoothly, whatever lobe they had in x.
    path[b].lobe = Lobe::Smooth;
    if (a >= 0) {
        path[a].lobe = Lobe::Smooth;
    } else if (context_.scene().emitterAt(path[0]) == kNone) {
        return Reject::ZeroTarget;
    }
    if (!evaluate(context_.scene(), path, std::max(l_, 0), std::min(m_, path.length()), y_.factors)) return Reject::ZeroTarget;
    if (a >= 0 && !context_.tracing.visible(path[a], path[b])) return Reject::Occluded;
    return Reject::None;
}

}  // namespace ulam
