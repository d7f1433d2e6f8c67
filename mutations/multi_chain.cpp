// multi_chain: a lens perturbation that goes on through several specular chains, where the direction off the vertices
// between them changes a little too (Veach 1997, §11.4.3.3).

#include "core/mcmc/lens_perturbation.h"

namespace ulam {
namespace {

class MultiChain : public Mutation {
public:
    struct Parameters {
        double minRadius = 0.1, maxRadius = 30, minAngle = 1e-4, maxAngle = 0.1;
        template <class V>
        void describe(V& v) {
            v("min_radius", minRadius, {.help = "smallest step of the raster position", .unit = "pixels", .min = 1e-4, .max = 1e6});
            v("max_radius", maxRadius, {.help = "largest step of the raster position", .unit = "pixels", .min = 1e-4, .max = 1e6});
            v("min_angle", minAngle, {.help = "smallest change of direction between specular chains", .unit = "radians", .min = 1e-6, .max = 1});
            v("max_angle", maxAngle, {.help = "largest change of direction between specular chains", .unit = "radians", .min = 1e-6, .max = 1});
        }
    };
    explicit MultiChain(const Parameters& p) : perturbation_({p.minRadius, p.maxRadius}, {p.minAngle, p.maxAngle}) {
        if (!(p.minRadius < p.maxRadius)) fail(ExitCode::InvalidConfig, "multi_chain: min_radius ({}) must be below max_radius ({})", p.minRadius, p.maxRadius);
        if (!(p.minAngle < p.maxAngle)) fail(ExitCode::InvalidConfig, "multi_chain: min_angle ({}) must be below max_angle ({})", p.minAngle, p.maxAngle);
    }

    Space space() const override { return Space::Path; }
    double suitability(const Sample& x) const override { return end(x.path) >= 0; }
    Proposal propose(const Sample& x, StepContext& context) const override { return perturbation_.propose(x, end(x.path), context); }
    std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext& context) const override {
        return perturbation_.logDensity(context.tracing, from, to, end(to.path));
    }

private:
    static int end(const Path& x) {
        int turns;
        const int m = LensPerturbation::end(x, turns);
        return turns > 0 ? m : -1;
    }

    LensPerturbation perturbation_;
};

ULAM_REGISTER_MUTATION(MultiChain, "multi_chain", "a lens perturbation through several specular chains");

}  // namespace
}  // namespace ulam
