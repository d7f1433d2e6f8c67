#pragma once
// The interface of every algorithm that turns a scene and a budget into an image. A sampler file describes one unit of
// its work; the driver (driver.h) has the threads, budgets, snapshots and progress.

#include "core/base/archive.h"
#include "core/base/memory.h"
#include "core/config/registry.h"
#include "core/path/walk.h"
#include "core/render/parallel.h"
#include "core/render/statistics.h"
#include "core/scene/scene.h"

#include <memory>
#include <optional>

namespace ulam {

/// What a run is told.
struct RunContext {
    const Scene& scene;
    RandomKey key;
    int workers;             ///< threads; each has its own film and scratch space
    double expectedUnits;    ///< samples or mutations the budget may allow, as far as known (0: unknown)
    double expectedSeconds;  ///< time budget (0: none)
    double expectedRays;     ///< budget of rays (0: none)

    double pixels() const { return double(scene.sensor->width()) * scene.sensor->height(); }
};

/// What a run holds at most in a part of its time, beside the scene and finished images.
struct MemoryPhase {
    MemoryNeeds parts = {};
    double state = 0;  ///< bytes that SamplerRun::save writes then
};

/// Films of as many threads, all there at once.
inline MemoryNeed filmsOf(int threads, double bytesEach) {
    const std::string whose = threads == 1 ? "the film of a thread" : fmt::format("the films of {} threads", threads);
    return {whose, threads * bytesEach, "a smaller film or fewer threads"};
}

/// One run of a sampler. Work comes in units (samples, or mutations for chains), numbered from 0. The image depends on
/// which units are done and not on who did them or when.
class SamplerRun {
public:
    virtual ~SamplerRun() = default;

    /// Before the first unit: seeding, normalisation. May use context.workers threads. False where `stop` said so before
    /// it was done: it is called again to go on, or `settle` has it make do with what there is.
    virtual bool prepare(const StopFunction& /*stop*/) { return true; }
    virtual void settle() {}
    /// Units handed out at a time, and the alignment of their ranges.
    virtual uint64_t chunk() const = 0;
    /// Does units [begin, end) of one chunk.
    virtual void work(int worker, uint64_t begin, uint64_t end) = 0;
    /// The image after `units` units; between rounds of work.
    virtual Image develop(uint64_t units) = 0;
    /// Rays traced so far by all workers; called between rounds of work.
    virtual uint64_t rays() const = 0;
    virtual void report(uint64_t units, RenderStatistics& statistics) = 0;

    /// Everything that was made so far, between rounds of work or of preparation; and back, into a run that was just
    /// started with the same context, but for the number of workers.
    virtual void save(ByteWriter& state) = 0;
    virtual void restore(ByteReader& state) = 0;

    /// Makes a sample or a step again, in a run that was just started, and tells what it was (replay.h).
    virtual Json replay(const NonFiniteEvent& event) = 0;

    /// A bias that the sampler knows of, for the result; nothing: none.
    void noteBias(const std::optional<std::string>& bias) {
        if (bias) biasLedger_.push_back(*bias);
    }
    const std::vector<std::string>& biasLedger() const { return biasLedger_; }

private:
    std::vector<std::string> biasLedger_;
};

class Sampler {
public:
    static const char* kind() { return "sampler"; }
    virtual ~Sampler() = default;

    /// Are its units mutations of Markov chains?
    virtual bool isChainSampler() const { return false; }
    /// The phases of a run, as far as their memory differs; told without starting it. None: it does not say.
    virtual std::vector<MemoryPhase> memory(const RunContext& /*context*/) const { return {}; }
    virtual std::unique_ptr<SamplerRun> start(const RunContext& context) const = 0;
};

}  // namespace ulam

#define ULAM_REGISTER_SAMPLER(Type, name, summary) ULAM_REGISTER(::ulam::Sampler, Type, name, summary)
