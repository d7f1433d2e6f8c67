// caustic: changes the direction in which light enters the last specular chain before the vertex that the camera sees,
// follows the chain and joins its new end to the lens (Veach 1997, §11.4.3.2).

#include "core/mcmc/perturbation.h"

namespace ulam {
namespace {

class Caustic : public Mutation {
public:
    struct Parameters {
        double minAngle = 1e-4, maxAngle = 0.1;
        int fewestSpecular = 1;
        template <class V>
        void describe(V& v) {
            v("min_angle", minAngle, {.help = "smallest change of direction", .unit = "radians", .min = 1e-6, .max = 1});
            v("max_angle", maxAngle, {.help = "largest change of direction", .unit = "radians", .min = 1e-6, .max = 1});
            v("fewest_specular", fewestSpecular, {.help = "specular bounces the chain must have; 0: any path that ends on a surface seen by the camera", .min = 0, .max = kMaxDepth});
        }
    };
    explicit Caustic(const Parameters& p) : direction_(p.minAngle, p.maxAngle), fewestSpecular_(p.fewestSpecular) {
        if (!(p.minAngle < p.maxAngle)) fail(ExitCode::InvalidConfig, "caustic: min_angle ({}) must be below max_angle ({})", p.minAngle, p.maxAngle);
    }

    Space space() const override { return Space::Path; }
    double suitability(const Sample& x) const override { return start(x.path) >= 0; }

    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        const int k = x.path.length(), s = start(x.path);
        const Perspective& sensor = *context.scene().sensor;
        const Block u = context.random.nextBlock();
        Vertex lens;
        if (!AperturePerturbation::sample(sensor, x.path.camera(), u, lens)) {
            p.reject = Reject::OffScreen;
            return p;
        }
        PathEdit edit(x, s, k + 1, k + 1 - s, context, p.y);
        edit.takeFromCamera(lens);
        p.y.path[s].lobe = Lobe::Smooth;
        p.reject = edit.growFromLightAlong(direction_.sample(context.tracing.directionOfRay(x.path[s], x.path[s + 1]), u));
        for (int i = s + 1; i < k - 1 && p.reject == Reject::None; ++i) p.reject = edit.followFromLight(x.path[i].lobe);
        if (p.reject != Reject::None || (p.reject = edit.join()) != Reject::None) return p;
        p.logForward = *logDensity(x, p.y, context);
        p.logReverse = *logDensity(p.y, x, context);
        rejectIfRoundedAway(p);
        return p;
    }

    std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext& context) const override {
        const int k = to.path.length(), s = start(to.path);
        const PathFactors& f = to.factors;
        const Tracing& tracing = context.tracing;
        const Vec3f before = tracing.directionOfRay(from.path[s], from.path[s + 1]), after = tracing.directionOfRay(to.path[s], to.path[s + 1]);
        double sum = std::log(f.edge[s].toAreaB(direction_.pdf(before, after)) *
                              AperturePerturbation::pdf(*context.scene().sensor, from.path.camera(), to.path.camera()));
        for (int i = s + 2; i < k; ++i) sum += logFollowedFromLight(context.scene(), to.path, f, i);
        return sum;
    }

private:
    /// The vertex whose direction changes: behind the delta vertices that precede x_{k−1}. −1 where there is none.
    int start(const Path& x) const {
        const int end = x.length() - 1;
        if (end < 1 || isDelta(x[end].lobe)) return -1;
        int s = end - 1;
        while (s > 0 && isDelta(x[s].lobe)) --s;
        // A direction at infinity has no direction to change.
        return end - 1 - s >= fewestSpecular_ && !x[s].atInfinity() ? s : -1;
    }

    AnglePerturbation direction_;
    int fewestSpecular_;
};

ULAM_REGISTER_MUTATION(Caustic, "caustic", "changes the direction into the specular chain that makes a caustic");

}  // namespace
}  // namespace ulam
