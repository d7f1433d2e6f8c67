#pragma once
// Target functions: what chains are distributed as, and how states of either space are evaluated.

#include "core/mcmc/sample.h"
#include "core/path/bidirectional.h"

namespace ulam {

/// The scalar π of a colour, homogeneous of degree 1 (so that π(w f / p) = w π(f) / p).
class Importance {
public:
    static const char* kind() { return "target"; }
    virtual ~Importance() = default;
    virtual double operator()(const Spectrum& f) const = 0;
};

/// By registered name; unknown names fail with the nearest one.
std::unique_ptr<Importance> makeImportance(const std::string& name);

/// One worker's evaluator of the target; holds scratch space, so it is not shared between threads.
class Target {
public:
    virtual ~Target() = default;

    virtual Space space() const = 0;
    virtual Tracing& tracing() = 0;
    /// A Primary proposal: y from y.u, which is extended from `random`, or cut, to what is used.
    virtual Reject evaluateNumbers(Sample& y, Random& random) = 0;
    /// A Path proposal: π and the splat from y.path and y.factors.
    virtual Reject evaluatePath(Sample& y) = 0;
    /// Draws the technique of a state of a Path target from c(·|x) and finds numbers u that make x (`invertNumbers`; the
    /// auxiliary ones from `random`); fills logDensity. Returns log c, or −∞ where there are no such numbers.
    virtual double redrawTechnique(Sample& x, Random& random, bool invertNumbers) = 0;
    /// log c(technique | y), and y.logDensity.
    virtual double logTechnique(Sample& y) = 0;

    /// One sample of the bootstrap: the sum of its contributions' π, an unbiased estimate of b.
    virtual double bootstrapWeight(Random& random) = 0;
    /// Repeats a bootstrap sample and makes it a chain's first state (for a Path target: one of its paths, drawn by π).
    virtual bool seed(Random& random, double choice, Sample& x) = 0;
};

/// π(u) = Σ π(contributions) over a whole sample of bidirectional path tracing or path tracing.
std::unique_ptr<Target> makePrimaryTarget(const Scene& scene, const BidirectionalOptions& options, const Importance& importance);
/// π(x) = π(f(x)) over paths.
std::unique_ptr<Target> makePathTarget(const Scene& scene, const BidirectionalOptions& options, const Importance& importance);

}  // namespace ulam

#define ULAM_REGISTER_TARGET(Type, name, summary) ULAM_REGISTER(::ulam::Importance, Type, name, summary)
