// lens_subpath: replaces everything from the camera to the first vertex that is not specular by a new walk from a
// uniform raster position (Veach 1997, §11.4.4). The raster position is drawn independently for each proposal: taking
// them in stratified order would make the next proposal known, which detailed balance does not allow.

#include "core/mcmc/perturbation.h"

namespace ulam {
namespace {

class LensSubpath : public Mutation {
public:
    struct Parameters {
        template <class V>
        void describe(V&) {}
    };
    explicit LensSubpath(const Parameters&) {}

    Space space() const override { return Space::Path; }

    double suitability(const Sample& x) const override {
        const int m = firstSmoothFromCamera(x.path);
        return m == 0 ? hittable(x.path.light()) : !isDelta(x.path[m - 1].lobe);
    }

    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        const Scene& scene = context.scene();
        const int k = x.path.length(), m = firstSmoothFromCamera(x.path);
        // The walk is made aside, because its length is not known beforehand.
        const PathLimits endless{context.limits.maxDepth, kMaxDepth};
        PrimaryVector scratch;
        Numbers numbers(scratch, context.random);
        Subpath walk;
        const Vec2f raster = scene.sensor->sampleRaster(numbers(NumberStream::Camera, 0));
        walkFromCamera(context.tracing, endless, 2, raster, numbers, walk);
        if (walk.size < 2) return p.reject = Reject::Missed, p;
        const int most = context.limits.maxDepth + 1 - m;
        while (walk.size < most && isSpecular(scene, walk))
            if (!extendWalk(context.tracing, endless, From::Camera, numbers(NumberStream::Camera, walk.size - 1), walk)) return p.reject = Reject::Missed, p;
        if (walk.size > most || isSpecular(scene, walk)) return p.reject = Reject::ZeroTarget, p;

        PathEdit edit(x, m - 1, k, walk.size, context, p.y);
        for (int i = 1; i < walk.size; ++i) edit.takeFromCamera(walk.vertex[size_t(i)]);
        if ((p.reject = edit.join()) != Reject::None) return p;
        p.logForward = *logDensity(x, p.y, context);
        p.logReverse = *logDensity(p.y, x, context);
        return p;
    }

    std::optional<double> logDensity(const Sample&, const Sample& to, StepContext& context) const override {
        // A walk does not stop at a mirror that shines.
        const Vertex& x0 = to.path.light();
        if (firstSmoothFromCamera(to.path) == 0 && x0.onSurface() && !context.scene().materialAt(x0).hasSmooth())
            return -std::numeric_limits<double>::infinity();
        double sum = 0;
        for (int i = to.path.length() - 1; i >= firstSmoothFromCamera(to.path); --i) sum += std::log(to.factors.fromCamera(i));
        return sum;
    }

private:
    /// Does the walk's last vertex scatter by delta lobes only, on the side where the walk arrived?
    static bool isSpecular(const Scene& scene, const Subpath& walk) {
        const Vertex& v = walk.vertex[size_t(walk.size - 1)];
        if (!v.onSurface()) return false;
        const float cosTheta = dot(v.shadingNormal, directionTo(v, walk.vertex[size_t(walk.size - 2)]));
        return scene.materialAt(v).onSideOf(cosTheta, [](const auto& bsdf, bool) { return !bsdf.hasSmooth; });
    }
};

ULAM_REGISTER_MUTATION(LensSubpath, "lens_subpath", "a new walk from the camera to the first vertex that is not specular");

}  // namespace
}  // namespace ulam
