// gaussian_step: every number moves by a normal deviate, wrapped around the unit interval.

#include "core/mcmc/small_steps.h"

namespace ulam {
namespace {

class GaussianStep : public Mutation {
public:
    struct Parameters {
        double sigma = 0.01;
        template <class V>
        void describe(V& v) {
            v("sigma", sigma, {.help = "standard deviation of a number's step", .min = 0, .max = 0.2, .minExclusive = true});
        }
    };
    explicit GaussianStep(const Parameters& p) : sigma_(p.sigma) {}

    Space space() const override { return Space::Primary; }

    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        moveNumbers(x.u, p.y.u, context.random,
                    [this](double u, Random& random) {
                        const double a = random(), b = random();
                        return wrapped(u, sigma_ * squareToNormal(a, b));
                    });
        return p;
    }

    std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext&) const override {
        return logMoves(from.u, to.u, [this](double d) {
            // The wrapped normal; two turns either way are below double precision for sigma ≤ 0.2.
            double density = 0;
            for (int turn = -2; turn <= 2; ++turn) density += std::exp(-0.5 * (d + turn) * (d + turn) / (sigma_ * sigma_));
            return std::log(density / (sigma_ * std::sqrt(2 * kPi)));
        });
    }

private:
    double sigma_;
};

ULAM_REGISTER_MUTATION(GaussianStep, "gaussian_step", "normally distributed steps of all primary numbers");

}  // namespace
}  // namespace ulam
