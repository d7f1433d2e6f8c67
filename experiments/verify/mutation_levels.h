#pragma once
// The levels of a mutation's audit, one function each.

#include "core/mcmc/audit/subject.h"
#include "core/render/parallel.h"
#include "experiments/verify/work.h"

namespace ulam::verify {

/// A scene to which the mutation applies, with a target.
struct Place {
    const audit::AuditScene* scene;
    Space target;
    audit::States states;
    std::string text;
};

/// Trials that a thread takes at a time.
inline constexpr uint64_t kChunk = 500;

struct MutationCase {
    MutationCase(const std::string& mutation, const AuditSettings& settings);

    std::string name;
    AuditSettings settings;
    RandomKey key;
    Space space;
    std::vector<Space> targets;
    std::vector<Place> places;

    const Work& work() const { return settings.work; }
    /// Šidák's level of this subject where the whole suite has `level`.
    double ownLevel(double level) const { return -std::expm1(std::log1p(-level) / double(settings.subjects)); }
};

/// Fills the case's places.
Finding findStates(MutationCase& c);
Finding auditStructure(const MutationCase& c);               // L0
Finding auditBalance(const MutationCase& c);                 // L1
Finding auditJacobian(const MutationCase& c);                // L1
Finding auditDensities(const MutationCase& c);               // L2
Finding auditInvariance(const MutationCase& c);              // L4
Finding auditImages(const MutationCase& c, References& r);   // L5
/// L6: L4 and L5 once more, in a mix with partners at unequal random weights.
Finding auditMixedInvariance(const MutationCase& c);
Finding auditMixedImages(const MutationCase& c, References& r);
Finding reportMixing(const MutationCase& c, References& r);  // L7

/// Shares trials out to threads, `chunk` at a time; the tallies are merged in order, so that the threads do not matter.
template <class Tally, class Part>
Tally inParallel(int threads, uint64_t count, uint64_t chunk, const Part& part) {
    std::vector<Tally> tallies(size_t((count + chunk - 1) / chunk));
    forEachChunk(
        threads, 0, count, chunk, [](int) { return false; },
        [&](int, uint64_t begin, uint64_t end) { tallies[size_t(begin / chunk)] = part(begin, end); });
    Tally sum;
    for (const Tally& tally : tallies) sum.merge(tally);
    return sum;
}

}  // namespace ulam::verify
