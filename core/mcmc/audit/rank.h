#pragma once
// Audit level L4, the exact rank test (Gandy & Scott 2020, §3.2): a chain of a kernel that leaves π invariant is
// started in its middle from an exact draw of π and run to either side; the rank of the start among all states is
// uniform. The kernel is reversible, so backward is the kernel itself.
//
// The target is a toy of two primary numbers (a ridge, a peak and an empty region), from which rejection draws exactly.
// So the test is one of Primary mutations.

#include "core/mcmc/audit/subject.h"

namespace ulam::audit {

inline constexpr int kRanks = 16;

struct RankTally {
    uint64_t chains = 0;
    /// Of both numbers and of log π.
    std::array<std::array<uint64_t, kRanks>, 3> counts{};
    void merge(const RankTally& later);
};

RankTally auditRanks(const AuditScene& scene, const Subject& subject, RandomKey key, uint64_t begin, uint64_t end);

/// Smallest p of the chi-square tests, times their number.
double rankTest(const RankTally& tally);

}  // namespace ulam::audit
