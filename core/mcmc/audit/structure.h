#pragma once
// Audit level L0: the structure of proposals. The same seed gives the same bits; the current state is untouched; a
// proposed path passes the validator and its factors are those computed from scratch; nothing that is not finite is
// accepted; a state holds just the numbers it is evaluated from; a step ends with the old state or the proposal, whole,
// and what the kernel keeps with it. A quarter of the trials use extreme random numbers.

#include "core/mcmc/audit/subject.h"

namespace ulam::audit {

/// Largest share of steps with ordinary numbers that single-precision geometry may leave without an acceptance ratio.
inline constexpr double kNotFiniteShare = 1e-3;

struct StructureTally {
    uint64_t trials = 0, proposals = 0;
    uint64_t notFinite =
        0;  ///< steps with ordinary numbers whose acceptance ratio was no number: refused by the kernel
    std::array<uint64_t, kRejectReasons> rejected{};
    Failures failures;
    void merge(const StructureTally& later);
};

/// Trials [begin, end): the t-th starts at state t modulo their number. The watcher, if any, sees their steps.
StructureTally auditStructure(const AuditScene& scene, const Subject& subject, const States& states, RandomKey key,
                              uint64_t begin, uint64_t end, StepObserver* watcher = nullptr);

}  // namespace ulam::audit
