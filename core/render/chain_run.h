#pragma once
// A run of many Markov chains: seeding, the round over the chains, and the deposits on the film.

#include "core/image/film.h"
#include "core/mcmc/kernel.h"
#include "core/render/sampler.h"
#include "core/render/seeding.h"

#include <atomic>

namespace ulam {

/// What the samplers with chains have in common.
struct ChainParameters {
    int chains = 1000;
    int bootstrap = 0;
    std::string target = "luminance";
    bool acceptanceImages = false;
    template <class V>
    void describe(V& v) {
        v("chains", chains, {.help = "Markov chains, whatever the number of threads", .min = 1, .max = 1e6});
        v("bootstrap", bootstrap, {.help = "bidirectional samples that seed the chains and give the image's scale; 0: as many as the image's expected error asks for, for 1/20 to 1/2 of the budget", .min = 0, .max = 1e8});
        v("target", target, {.help = "what chains are distributed as: a scalar of the contribution (ulam list targets)"});
        v("acceptance_images", acceptanceImages, {.help = "also write how many proposals were made from states in each pixel, and how many of them were accepted"});
    }
};

/// How steps turn into an image.
enum class Deposit {
    ExpectedValues,  ///< α to the proposal, 1 − α to the current state (Veach 1997, §11.3.3)
    /// Large steps also count as independent samples (Kelemen et al. 2002, §4). With p the probability of a large step and
    /// b0 an independent estimate of b, a state weighs π / (π + p b0) as one of the chain's and p b0 / (π + p b0) as a
    /// large step's: whatever b0 is, the two add up to the image. With the b of the bootstrap itself, from which the
    /// chains are drawn, the weights would depend on the states they weigh.
    Kelemen,
};

using TargetMaker = std::function<std::unique_ptr<Target>()>;

class ChainRun : public SamplerRun {
public:
    /// Steps a chain takes before the next one's turn: long enough to keep its state in the cache.
    static constexpr uint64_t kChunk = 64;

    ChainRun(const RunContext& context, const ChainParameters& parameters, const BidirectionalOptions& options, MutationMix mix, Deposit deposit,
             const TargetMaker& makeTarget);
    ~ChainRun() override;

    /// For Sampler::memory.
    static std::vector<MemoryPhase> memory(const RunContext& context, const ChainParameters& parameters, const PathLimits& limits);

    bool prepare(const StopFunction& stop) override;
    void settle() override;
    uint64_t chunk() const override { return kChunk; }
    void work(int worker, uint64_t begin, uint64_t end) override;
    Image develop(uint64_t units) override;
    uint64_t rays() const override;
    void report(uint64_t units, RenderStatistics& statistics) override;
    void save(ByteWriter& state) override { archive(state); }
    void restore(ByteReader& state) override { archive(state); }
    Json replay(const NonFiniteEvent& event) override;

private:
    struct Worker;
    struct ChainSlot;

    struct Cost {
        double seconds, rays;
    };

    Worker& gathered();
    template <class Archive>
    void archive(Archive& a);
    bool weigh(const BootstrapNumbers& numbers, uint64_t last, const StopFunction& stop, std::vector<double>& weights);
    bool growPilot(const StopFunction& stop);
    bool planBootstrap(const StopFunction& stop);
    double fractionOfBudget(const Cost& cost, double units) const;
    std::optional<Cost> tryMutations(const StopFunction& stop);
    bool startChain(Worker& worker, const BootstrapNumbers& numbers, const Start& start, Chain& chain);
    void seedChains();
    void step(Worker& worker, Chain& chain, StepObserver& observer);
    void logNonFinite(Worker& worker, const Chain& chain, uint64_t unit);
    void timedStep(Worker& worker, Chain& chain);

    RunContext context_;
    ChainParameters parameters_;
    BidirectionalOptions options_;  ///< of the samples that seed the chains
    MutationMix mix_;
    Deposit deposit_;
    std::vector<std::unique_ptr<Worker>> workers_;
    std::vector<std::unique_ptr<ChainSlot>> chains_;
    BootstrapNumbers pilotNumbers_, bootstrapNumbers_;
    // Of the seeding while it lasts:
    std::vector<double> pilot_, weights_;
    uint64_t pilotGoal_, bootstrapGoal_;  ///< samples to be made; the bootstrap's is 0 until it is known
    double pilotSeconds_ = 0;
    // What remains of it:
    std::optional<SeedingPlan> plan_;  ///< none where the size of the bootstrap is given
    WeightMoments bootstrap_;
    double pilotNormalization_ = 0;  ///< b from samples that seed nothing
    uint64_t pilotSamples_ = 0, seedsLost_ = 0;
    uint64_t raysBefore_ =
        0;  ///< traced before the run was restored; less those of trials that were stopped, modulo 2⁶⁴
    std::atomic<bool> failed_ = false;  ///< a step threw; workers that wait for its chain give up
};

}  // namespace ulam
