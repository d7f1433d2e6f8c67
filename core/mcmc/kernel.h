#pragma once
// The Metropolis–Hastings kernel: the one place where proposals are accepted or rejected.

#include "core/base/non_finite.h"
#include "core/mcmc/mutation_mix.h"
#include "core/mcmc/target.h"

namespace ulam {

/// The state of one Markov chain.
struct Chain {
    uint32_t index = 0;  ///< its random numbers: (key, index, step)
    uint64_t step = 0;
    Sample x;
    std::vector<double> suitability;  ///< weight_j · suit_j(x)
    double z = 0;                     ///< their sum Z(x)
    uint32_t feature = kNone;         ///< label of x's brightest splat that has one

    template <class Archive>
    void archive(Archive& a) {
        a(index, step, x, suitability, z, feature);
    }
};

/// What one step did.
struct StepInfo {
    int mutation = -1;      ///< index in the mix; −1: a null step (no mutation suits the state)
    double acceptance = 0;  ///< α
    bool accepted = false;
    Reject reject = Reject::None;
    Cause cause = Cause::None;  ///< of NotFinite
};

/// Sees the state before, the proposal (meaningful if there is one) and what happened; the chain has not moved yet.
class StepObserver {
public:
    virtual ~StepObserver() = default;
    virtual void observe(const Chain& before, const Proposal& proposal, const StepInfo& info) = 0;
};

class Kernel {
public:
    explicit Kernel(const MutationMix& mix) : mix_(mix), scratch_(mix.size()) {}

    const MutationMix& mix() const { return mix_; }
    /// Fills what the kernel keeps about a chain's state; call after x was set from outside.
    void enter(Chain& chain) const;

    /// One step of the chain. Where Z(x) = 0 it is a null step, which the observer counts.
    void step(Chain& chain, Target& target, StepContext& context, StepObserver& observer);

    /// log r of a proposal whose target is evaluated (design: "the kernel's one formula"), for β = 1. `logTechnique` is
    /// log c(y) − log c(x) of a Primary mutation on a Path target.
    double logRatio(const Chain& chain, int mutation, const Proposal& proposal, Space target, double logTechnique, double suitabilityY,
                    double zY) const;

private:
    const MutationMix& mix_;
    std::vector<double> scratch_;
};

}  // namespace ulam
