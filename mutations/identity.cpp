// identity: proposes the current state. It leaves every distribution invariant, which makes it a test of everything
// around a mutation.

#include "core/mcmc/sample.h"

namespace ulam {
namespace {

class Identity : public Mutation {
public:
    struct Parameters {
        template <class V>
        void describe(V&) {}
    };
    explicit Identity(const Parameters&) {}

    Space space() const override { return Space::Path; }
    Proposal propose(const Sample& x, StepContext&) const override {
        Proposal p;
        p.y.path = x.path;
        p.y.factors = x.factors;
        return p;
    }
    std::optional<double> logDensity(const Sample&, const Sample&, StepContext&) const override { return 0; }
};

ULAM_REGISTER_MUTATION(Identity, "identity", "proposes the current state, for tests");

}  // namespace
}  // namespace ulam
