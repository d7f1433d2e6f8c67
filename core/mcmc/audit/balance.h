#pragma once
// Audit level L1, the pointwise balance of the kernel as it runs: for each step the densities that the mutation stated
// are computed afresh, and f(x) q(x→y) α = f(y) q(y→x) α′ is checked with the α that the kernel used, selection of the
// mutation included.

#include "core/mcmc/audit/subject.h"

namespace ulam::audit {

/// Largest relative residual that passes: of paths in float geometry, and of numbers in double.
inline constexpr double kPathResidual = 1e-4, kPrimaryResidual = 1e-9;

struct BalanceTally {
    uint64_t steps = 0, pairs = 0;  ///< steps of the mutation, and those that had a proposal
    bool hasDensity = true;         ///< the mutation has logDensity
    double worst = 0;               ///< largest residual
    uint64_t worstTrial = 0;
    Failures failures;
    void merge(const BalanceTally& later);
};

/// Trials [begin, end), from states as in the audit of structure, with a watcher as there.
BalanceTally auditBalance(const AuditScene& scene, const Subject& subject, const States& states, RandomKey key,
                          uint64_t begin, uint64_t end, StepObserver* watcher = nullptr);

}  // namespace ulam::audit
