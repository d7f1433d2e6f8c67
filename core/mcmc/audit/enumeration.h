#pragma once
// Audit level L3: the transition matrix of the kernel on a tiny discrete space, by enumeration. The kernel's random
// numbers are scripted so that every choice is made as often as its probability says, and the acceptance is taken from
// what it tells its observer; then π P = π must hold to rounding.
//
// The toy has mutations of states and of numbers, asymmetric, deterministic with a Jacobian, and independent ones;
// unequal weights and suitabilities that vary with the state; states without light, and one that no mutation suits.

#include "core/mcmc/sample.h"

namespace ulam::audit {

inline constexpr double kEnumerationResidual = 1e-12;

struct Enumeration {
    uint64_t steps = 0, nullSteps = 0;
    double residual = 0;  ///< largest |(π P − π)_j|, π normalised
};

/// Of a target over paths (states here) or numbers. `misstated`: one mutation takes its density for the way back for the
/// way there, which tests see rejected.
Enumeration enumerateKernel(Space target, bool misstated = false);

}  // namespace ulam::audit
