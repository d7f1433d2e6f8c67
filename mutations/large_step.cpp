// large_step: fresh numbers, independent of the current state (Kelemen et al. 2002, §3.2). On a Path target the technique
// is kept, so the path's length is too.

#include "core/mcmc/sample.h"

namespace ulam {
namespace {

class LargeStep : public Mutation {
public:
    struct Parameters {
        template <class V>
        void describe(V&) {}
    };
    explicit LargeStep(const Parameters&) {}

    Space space() const override { return Space::Primary; }
    bool isLargeStep() const override { return true; }
    /// Uniform on the unit cube: y.u is left empty and extended with uniform numbers as it is used.
    Proposal propose(const Sample&, StepContext&) const override { return {}; }
    std::optional<double> logDensity(const Sample&, const Sample&, StepContext&) const override { return 0; }
};

ULAM_REGISTER_MUTATION(LargeStep, "large_step", "an independent sample: all numbers are drawn afresh");

}  // namespace
}  // namespace ulam
