// lens: moves the raster position and follows the path's specular bounces to the first vertex that is not specular, which
// is joined to the rest of the path (Veach 1997, §11.4.3.1).

#include "core/mcmc/lens_perturbation.h"

namespace ulam {
namespace {

class Lens : public Mutation {
public:
    struct Parameters {
        double minRadius = 0.1, maxRadius = 30;
        template <class V>
        void describe(V& v) {
            v("min_radius", minRadius, {.help = "smallest step of the raster position", .unit = "pixels", .min = 1e-4, .max = 1e6});
            v("max_radius", maxRadius, {.help = "largest step of the raster position", .unit = "pixels", .min = 1e-4, .max = 1e6});
        }
    };
    explicit Lens(const Parameters& p) : perturbation_({p.minRadius, p.maxRadius}, {}) {
        if (!(p.minRadius < p.maxRadius)) fail(ExitCode::InvalidConfig, "lens: min_radius ({}) must be below max_radius ({})", p.minRadius, p.maxRadius);
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
        return turns == 0 ? m : -1;
    }

    LensPerturbation perturbation_;
};

ULAM_REGISTER_MUTATION(Lens, "lens", "moves the point on the film and follows the same specular bounces");

}  // namespace
}  // namespace ulam
