// kelemen_step: every number moves by ±s2·exp(−log(s2/s1)·ξ), small steps being the likelier (Kelemen et al. 2002, §3.2).

#include "core/mcmc/small_steps.h"

namespace ulam {
namespace {

class KelemenStep : public Mutation {
public:
    struct Parameters {
        double smallest = 1.0 / 1024, largest = 1.0 / 64;
        template <class V>
        void describe(V& v) {
            v("smallest", smallest, {.help = "smallest step s1 of a number", .min = 0, .max = 0.5, .minExclusive = true});
            v("largest", largest, {.help = "largest step s2 of a number", .min = 0, .max = 0.5, .minExclusive = true});
        }
    };
    explicit KelemenStep(const Parameters& p) : parameters_(p), logRatio_(std::log(p.largest / p.smallest)) {
        if (!(p.smallest < p.largest)) fail(ExitCode::InvalidConfig, "kelemen_step: smallest ({}) must be below largest ({})", p.smallest, p.largest);
    }

    Space space() const override { return Space::Primary; }

    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        moveNumbers(x.u, p.y.u, context.random, [this](double u, Random& random) {
            double xi = random() * 2;
            const double sign = xi < 1 ? 1 : -1;
            if (xi >= 1) xi -= 1;
            // In single precision, at half the cost: the size of a step is random anyway.
            return wrapped(u, sign * parameters_.largest * double(std::exp(float(-logRatio_ * xi))));
        });
        return p;
    }

    std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext&) const override {
        return logMoves(from.u, to.u, [this](double d) {
            d = std::abs(d);
            // The support is wider by the rounding of the size, and of wrapping to the numbers' last place.
            constexpr double kRounding = 1e-6;
            if (d < parameters_.smallest * (1 - kRounding) - 1e-12 || d > parameters_.largest * (1 + kRounding) + 1e-12) return -std::numeric_limits<double>::infinity();
            return -std::log(2 * d * logRatio_);
        });
    }

private:
    Parameters parameters_;
    double logRatio_;
};

ULAM_REGISTER_MUTATION(KelemenStep, "kelemen_step", "small steps of all primary numbers, sizes distributed as 1/s");

}  // namespace
}  // namespace ulam
