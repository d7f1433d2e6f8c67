#pragma once
// Audit level L1, the independent part: the density that a mutation states against the one found by displacing its
// random numbers (number_map.h).
//
// The map is single-precision geometry, so single comparisons carry noise. They are sorted by the shape of the path and
// what of it moved, and the median of each class is judged, of rare ones together. Where several choices can make the
// same path the density of one branch only bounds the stated one from below.

#include <map>

#include "core/mcmc/audit/number_map.h"
#include "core/mcmc/audit/subject.h"

namespace ulam::audit {

/// Largest |median| of log stated − log found that passes (besides four of its own standard errors), largest distance
/// from it of three comparisons in four, and the fewest states a class is judged by, and its scatter.
inline constexpr double kJacobianTolerance = 0.01, kJacobianScatter = 0.12, kScatterQuantile = 0.75;
inline constexpr size_t kFewestStates = 7, kFewestForScatter = 20;

/// Largest share of states with light that may have no numbers that make them again; and of those without specular
/// vertices, of which the numbers may make another path, moved by more than half of what rays start off their surface.
inline constexpr double kNotInvertedShare = 1e-3, kMovedShare = 0.1;

struct JacobianTally {
    struct Comparison {
        double excess;  ///< log stated − log of the branch found
        bool only;      ///< there is no other branch: the excess must be zero, else it may be positive
        uint64_t state, trial;  ///< where it came from, the bootstrap sample; and its number
    };
    uint64_t proposals = 0, noisy = 0, notSquare = 0;
    uint64_t inversions = 0, notInverted = 0, firstNotInverted = 0;  ///< of states to numbers, those that failed, the first's trial
    uint64_t plain = 0, moved = 0, firstMoved = 0;  ///< inversions without specular vertices, those that make another path
    std::map<std::string, std::vector<Comparison>> classes;
    void merge(const JacobianTally& later);
};

struct JacobianVerdict {
    size_t comparisons = 0, equalities = 0;  ///< judged; of these with a single branch
    size_t classes = 0, unjudged = 0;        ///< classes judged, and those with too few states
    double worst = 0;                        ///< largest median
    double scatter = 0;                      ///< largest distance of three in four where there is one branch
    Failures failures;
};

/// Of a Path mutation: its proposals. Of a Primary mutation on a Path target: the map from numbers to paths, whose
/// density enters the acceptance. On a Primary target nothing is compared (see auditSteps).
JacobianTally auditJacobian(const AuditScene& scene, const Subject& subject, const States& states, RandomKey key,
                            uint64_t begin, uint64_t end, StepObserver* watcher = nullptr);
JacobianVerdict judge(const JacobianTally& tally);

}  // namespace ulam::audit
