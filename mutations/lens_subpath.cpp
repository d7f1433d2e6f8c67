// lens_subpath: replaces everything from the camera to the first vertex that is not specular by a new walk from a
// uniform raster position (Veach 1997, §11.4.4). Where a surface has both kinds of lobes, the walk stops as often as it
// would choose the smooth one. The raster position is drawn independently for each proposal: taking
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
        if (walk.size < 2) {
            p.reject = Reject::Missed;
            return p;
        }
        const int most = context.limits.maxDepth + 1 - m;
        for (;;) {
            const Block& u = numbers(NumberStream::Camera, walk.size - 1);
            if (u[2] >= 1 - stopping(scene, walk.vertex[size_t(walk.size - 1)], walk.vertex[size_t(walk.size - 2)])) break;
            if (walk.size >= most) {
                p.reject = Reject::ZeroTarget;
                return p;
            }
            if (!extendWalk(context.tracing, endless, From::Camera, u, walk)) {
                p.reject = Reject::Missed;
                return p;
            }
        }
        if (walk.size > most) {
            p.reject = Reject::ZeroTarget;
            return p;
        }

        PathEdit edit(x, m - 1, k + 1, walk.size + 1, context, p.y);
        for (int i = 0; i < walk.size; ++i) edit.takeFromCamera(walk.vertex[size_t(i)]);
        if ((p.reject = edit.join()) != Reject::None) return p;
        p.logForward = *logDensity(x, p.y, context);
        p.logReverse = *logDensity(p.y, x, context);
        return p;
    }

    std::optional<double> logDensity(const Sample&, const Sample& to, StepContext& context) const override {
        const Path& path = to.path;
        const int k = path.length(), m = firstSmoothFromCamera(path);
        double sum = std::log(context.scene().sensor->positionPdf(path.camera()) * stopping(context.scene(), path[m], path[m + 1]));
        for (int i = k - 1; i >= m; --i) sum += std::log(to.factors.fromCamera(i));
        return sum;
    }

private:
    /// Probability that the walk stops at v, where it arrived from `previous`; 0 at mirrors, also where they shine.
    static double stopping(const Scene& scene, const Vertex& v, const Vertex& previous) {
        return v.onSurface() ? smoothShare(scene, v, directionTo(v, previous)) : 1;
    }
};

ULAM_REGISTER_MUTATION(LensSubpath, "lens_subpath", "a new walk from the camera to the first vertex that is not specular");

}  // namespace
}  // namespace ulam
