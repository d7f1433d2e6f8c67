#include "core/mcmc/audit/guide.h"

namespace ulam::audit {
namespace {

/// How often a direction is drawn as path tracing does, rather than near the old one.
constexpr double kWalkShare = 0.3;

bool samePlace(const Vertex& a, const Vertex& b) {
    return a.position == b.position && a.kind == b.kind && a.shape == b.shape;
}

double angleBetween(const Vec3f& a, const Vec3f& b) {
    const Vec3d u(a), v(b);
    return std::atan2(u.cross(v).length(), u.dot(v));
}

}  // namespace

ProposalClass::ProposalClass(const Path& x, const Path& y) {
    const int k = x.length(), shift = y.length() - k;
    int l = -1, m = k + 1;
    while (l < std::min(k, k + shift) && samePlace(x[l + 1], y[l + 1])) ++l;
    while (m - 1 > l && m - 1 + shift > l && samePlace(x[m - 1], y[m - 1 + shift])) --m;
    kept = l, first = m, added = m + shift - l;
    for (int i = std::max(l, 0); i <= std::min(m + shift, y.length()); ++i)
        lobes += y[i].onSurface() ? "SRTN"[int(y[i].lobe)] : "SLPID"[int(y[i].kind)];
}

PathGuide::PathGuide(const AuditScene& scene, const Sample& x, const ProposalClass& c, const std::vector<Sample>& pilot)
    : scene_(scene), tracing_(scene.scene), x_(x), class_(c), pattern_(pilot.front().path) {
    const int k = pattern_.length(), shift = k - x.path.length(), l = c.kept;
    // The joining edge: as much as possible is grown from the camera.
    for (int n = 0; n <= c.grown() && fromLight_ < 0; ++n) {
        const int i = l + n;
        if (i < 0 ? hittable(pattern_[0]) : i < k && connectable(pattern_[i], pattern_[i + 1])) fromLight_ = n;
    }
    if (fromLight_ < 0) return;
    const auto add = [&](Growth g) {
        const bool end = g.camera && g.vertex == k;
        bool measured = end || g.raster;
        if (!measured && g.source >= 0) {
            const Vertex& from = pattern_[g.source];
            // Vertices are counted from the end the walk comes from.
            const int source = g.camera ? g.source - shift : g.source, vertex = g.camera ? g.vertex - shift : g.vertex;
            measured = !(from.onSurface() && isDelta(from.lobe)) && !from.atInfinity() && std::min(source, vertex) >= 0 &&
                       std::max(source, vertex) <= x.path.length() && !x.path[source].atInfinity();
            if (measured) g.center = tracing_.directionOfRay(x.path[source], x.path[vertex]);
        }
        if (measured) {
            std::vector<double> lengths;
            for (const Sample& y : pilot) lengths.push_back(lengthOf(g, y));
            g.length = PilotLength(std::move(lengths), end || g.raster ? std::numeric_limits<double>::infinity() : kPi);
        }
        growths_.push_back(std::move(g));
    };
    for (int i = l + c.added - 1; i > l + fromLight_; --i)
        add({.vertex = i, .source = i + 1, .camera = true, .raster = i == k - 1, .center = {}, .length = {}});
    for (int i = l + 1; i <= l + fromLight_; ++i)
        add({.vertex = i, .source = i - 1, .camera = false, .center = {}, .length = {}});
}

bool PathGuide::sample(StepContext& context, Random& random, Sample& y) const {
    PathEdit edit(x_, class_.kept, class_.first, class_.added, context, y);
    for (const Growth& g : growths_)
        if (grow(g, edit, random, y.path) != Reject::None) return false;
    return edit.join() == Reject::None;
}

double PathGuide::onLens(const Sample& y) const {
    const Perspective& sensor = *scene_.scene.sensor;
    return (sensor.onDisc(y.path.camera()) - sensor.onDisc(x_.path.camera())).length();
}

Reject PathGuide::grow(const Growth& g, PathEdit& edit, Random& random, Path& path) const {
    const Block u = random.nextBlock();
    const bool end = g.camera ? g.vertex == path.length() : g.vertex == 0;
    if (end && !g.camera) return edit.growFromLight(u);
    if (end) {
        if (g.length.empty() || random() < kWalkShare) return edit.growFromCamera(u);
        const double length = g.length.sample(u[0]), phi = 2 * kPi * u[1];
        const Perspective& sensor = *scene_.scene.sensor;
        const Vec2f p = sensor.onDisc(x_.path.camera()) + Vec2f(float(length * std::cos(phi)), float(length * std::sin(phi)));
        edit.takeFromCamera(sensor.lensPoint(p));
        return p.length2() < 1 ? Reject::None : Reject::OffScreen;
    }
    const Vertex& pattern = pattern_[g.source];
    if (pattern.onSurface() && isDelta(pattern.lobe))
        return g.camera ? edit.followFromCamera(pattern.lobe) : edit.followFromLight(pattern.lobe);
    if (g.length.empty() || random() < kWalkShare) {
        const Reject reject = g.camera ? edit.growFromCamera(u) : edit.growFromLight(u);
        return reject == Reject::None && path[g.source].onSurface() && isDelta(path[g.source].lobe) ? Reject::ZeroTarget : reject;
    }
    const double length = g.length.sample(u[0]), phi = 2 * kPi * u[1];
    path[g.source].lobe = Lobe::Smooth;
    if (g.raster) {
        const Vec2f raster = x_.splats[0].raster + Vec2f(float(length * std::cos(phi)), float(length * std::sin(phi)));
        const Perspective& sensor = *scene_.scene.sensor;
        return sensor.contains(raster) ? edit.growFromCameraAlong(sensor.direction(path[g.source], raster)) : Reject::OffScreen;
    }
    const double s = std::sin(length);
    const Vec3f local{float(s * std::cos(phi)), float(s * std::sin(phi)), float(std::cos(length))};
    const Vec3f direction = normalize(Frame(g.center).toWorld(local));
    return g.camera ? edit.growFromCameraAlong(direction) : edit.growFromLightAlong(direction);
}

double PathGuide::lengthOf(const Growth& g, const Sample& y) const {
    if (g.vertex == y.path.length()) return onLens(y);
    if (g.raster) return (y.splats[0].raster - x_.splats[0].raster).length();
    return angleBetween(g.center, tracing_.directionOfRay(y.path[g.source], y.path[g.vertex]));
}

bool PathGuide::covers(const Sample& y) const {
    return std::all_of(growths_.begin(), growths_.end(),
                       [&](const Growth& g) { return g.length.empty() || lengthOf(g, y) >= g.length.shortest(); });
}

double PathGuide::logDensity(const Sample& y) const {
    double sum = 0;
    for (const Growth& g : growths_) sum += std::log(pdf(g, y));
    return sum;
}

double PathGuide::pdf(const Growth& g, const Sample& y) const {
    const Scene& scene = scene_.scene;
    const PathFactors& f = y.factors;
    const int i = g.vertex;
    if (i == y.path.length()) {
        const double r = lengthOf(g, y), radius = scene.sensor->apertureRadius();
        const double local = r > 0 && radius > 0 ? g.length.pdf(r) / (2 * kPi * r * radius * radius) : 0;
        const double uniform = scene.sensor->positionPdf(y.path.camera());
        return g.length.empty() ? uniform : kWalkShare * uniform + (1 - kWalkShare) * local;
    }
    if (i == 0 && !g.camera) return emissionPositionPdf(scene, y.path.light());
    const double walk = g.camera ? f.fromCamera(i) : f.fromLight(i);
    const Vertex& pattern = pattern_[g.source];
    if (pattern.onSurface() && isDelta(pattern.lobe)) {
        const Vec3f toCamera = f.edge[size_t(g.source)].direction, toLight = -f.edge[size_t(g.source - 1)].direction;
        return walk / (g.camera ? lobeProbability(scene, y.path[g.source], toCamera, toLight)
                                : lobeProbability(scene, y.path[g.source], toLight, toCamera));
    }
    if (g.length.empty()) return walk;
    if (g.raster) {
        const double r = lengthOf(g, y);
        // `walk` is the density of a uniform raster position.
        const double local = r > 0 ? g.length.pdf(r) / (2 * kPi * r) * scene.sensor->windowArea() : 0;
        return walk * (kWalkShare + (1 - kWalkShare) * local);
    }
    const Edge& edge = f.edge[size_t(std::min(g.vertex, g.source))];
    const double theta = lengthOf(g, y), s = std::sin(theta);
    const double local = s > 0 ? g.length.pdf(theta) / (2 * kPi * s) : 0;
    return kWalkShare * walk + (1 - kWalkShare) * (g.camera ? edge.toAreaA(local) : edge.toAreaB(local));
}

}  // namespace ulam::audit
