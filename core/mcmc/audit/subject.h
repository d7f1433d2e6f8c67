#pragma once
// What the audit of a mutation works with: the mutation with its default parameters in a mix, an evaluator of the
// target, and states that the mutation applies to.

#include "core/mcmc/audit/scenes.h"
#include "core/mcmc/kernel.h"

namespace ulam::audit {

/// Streams of random numbers: the `chain` of their Randoms.
enum class Stream : uint32_t {
    Bootstrap = 0xa0000000u,
    Choice,
    Resampling,
    Structure,
    Edges,
    Balance,
    Jacobian,
    Alternatives,
    Normal,
    Start,
    Step,
    Rank,
    Density,
    Guide,
    Mix
};
inline Random randomOf(RandomKey key, Stream stream, uint64_t index) {
    return Random(key, uint32_t(stream), index);
}

struct Failure {
    uint64_t trial = 0;  ///< number of the trial: with the same seed it is repeated
    std::string message;
};

/// The first few failures, by trial, and how many there were.
class Failures {
public:
    static constexpr size_t kKept = 3;
    void add(uint64_t trial, std::string message);
    void merge(const Failures& later);
    uint64_t count() const { return count_; }
    const std::vector<Failure>& first() const { return first_; }

private:
    uint64_t count_ = 0;
    std::vector<Failure> first_;
};

/// A registered mutation (first of the mix) on a target of one kind, alone or among partners with unequal weights.
class Subject {
public:
    Subject(const std::string& mutation, Space target, const std::vector<std::string>& partners = {});
    /// In a mix as in an experiment, which the mutation comes first in.
    Subject(Space target, const Json& mix);

    const std::string& name() const { return mix_[0].name; }
    const Mutation& mutation() const { return *mix_[0].mutation; }
    Space target() const { return target_; }
    const MutationMix& mix() const { return mix_; }
    std::unique_ptr<Target> makeTarget(const AuditScene& scene) const;

private:
    Space target_;
    MutationMix mix_;
    std::unique_ptr<Importance> importance_;
};

/// Every registered mutation that works on such a target, the subject itself left out.
std::vector<std::string> partnersOf(const std::string& mutation, Space target);

/// States of bootstrap samples to which the mutation applies.
struct States {
    std::vector<Sample> x;
    std::vector<uint64_t> source;  ///< number of the bootstrap sample each is from: bright and rare ones come repeatedly
    uint64_t drawn = 0;     ///< bootstrap samples looked at
    uint64_t positive = 0;  ///< that carry light
    uint64_t suitable = 0;  ///< of these: the mutation applies
};

/// Half of the states are resampled by weight, as chains start; the other half are shared out evenly to the classes of
/// paths, so that rare and dim ones are there too. A shortest and a longest path are among them.
States drawStates(const AuditScene& scene, const Subject& subject, RandomKey key, uint64_t samples, size_t count);

/// "LSTRSC"-like picture of a path, light first: P point, I at infinity, S smooth, R and T delta lobes.
std::string pathClass(const Path& path);

}  // namespace ulam::audit
