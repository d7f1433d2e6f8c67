// uniform_step: every number moves by a uniform amount, wrapped around the unit interval. A mutation as a user adds it
// from outside: docs/plugins.md has the two commands.

#include "core/mcmc/small_steps.h"

namespace {

using namespace ulam;

class UniformStep : public Mutation {
public:
    struct Parameters {
        double size = 0.02;
        template <class V>
        void describe(V& v) {
            v("size", size, {.help = "longest step of a number", .min = 0, .max = 0.5, .minExclusive = true});
        }
    };
    explicit UniformStep(const Parameters& p) : size_(p.size) {}

    Space space() const override { return Space::Primary; }

    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        moveNumbers(x.u, p.y.u, context.random,
                    [this](double u, Random& random) { return wrapped(u, size_ * (2 * random() - 1)); });
        return p;
    }

    std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext&) const override {
        return logMoves(from.u, to.u, [this](double d) {
            // Wrapping rounds to the numbers' last place; the support is taken that much wider.
            return std::abs(d) <= size_ + 1e-12 ? -std::log(2 * size_) : -std::numeric_limits<double>::infinity();
        });
    }

private:
    double size_;
};

ULAM_REGISTER_MUTATION(UniformStep, "uniform_step", "uniform steps of all primary numbers");

}  // namespace
