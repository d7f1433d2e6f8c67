#pragma once
// Audit level L2: the density of proposals. Proposals of a mutation from one state, sorted into histograms, against the
// shares that logDensity says, bin by bin. These are integrals of exp(logDensity), estimated with samples that do not
// come from the mutation (guide.h), unbiased and with a standard error that is part of the chi-square.

#include "core/mcmc/audit/marginals.h"
#include "core/mcmc/audit/subject.h"

namespace ulam::audit {

/// The density may integrate to more than 1 by this many standard errors of the estimate.
inline constexpr double kMassErrors = 6;

struct DensityTest {
    std::string what;  ///< class of proposals
    uint64_t state = 0;
    uint64_t proposals = 0, references = 0;  ///< tries of either side
    std::vector<Marginal> marginals;         ///< the first is the mass of the class
};

struct DensityTally {
    uint64_t states = 0;
    uint64_t unjudged = 0;  ///< states without a class that is frequent enough and can be made independently
    bool hasDensity = true;
    std::vector<DensityTest> tests;
    Failures failures;  ///< densities that integrate to more than 1, beyond doubt
    void merge(const DensityTally& later);
};

/// State number `index`; `proposals` for either side. On a Path target without proposals per area (the mutation is one
/// of primary numbers) and on a Primary target the density is one of numbers.
DensityTally auditDensity(const AuditScene& scene, const Subject& subject, const Sample& state, RandomKey key,
                          uint64_t index, uint64_t proposals);

}  // namespace ulam::audit
