#include "core/render/chain_run.h"

#include "core/render/parallel.h"

#include <chrono>
#include <thread>

namespace ulam {
namespace {

// Streams of random numbers beside the chains' own, which are numbered from 0.
constexpr uint32_t kBootstrapStream = 0xf0000000u, kResamplingStream = 0xf0000001u;
// Timing every step would cost more than a cheap step.
constexpr uint64_t kTimedEvery = 32;

constexpr uint64_t kSmallestBootstrap = 20'000, kLargestBootstrap = 20'000'000;
constexpr double kBootstrapShare = 0.1;

bool neverStop(int) { return false; }

}  // namespace

struct ChainRun::ChainSlot {
    Chain chain;
    ChainTrace trace;
    std::atomic<uint64_t> steps = 0;  ///< finished; a worker that is ahead waits for them
};

/// One thread's film and counters; sees every step it makes.
struct ChainRun::Worker : StepObserver {
    Worker(const ChainRun& r, std::unique_ptr<Target> t)
        : run(r),
          target(std::move(t)),
          kernel(r.mix_),
          film(r.context_.scene.sensor->width(), r.context_.scene.sensor->height(), r.context_.scene.filter),
          statistics(r.mix_.size()),
          featureEnergy(r.context_.scene.features.names.size()),
          largeStepProbability(r.mix_.largeStepProbability()) {}

    void observe(const Chain& before, const Proposal& proposal, const StepInfo& info) override {
        last = info.mutation;
        if (info.mutation < 0) {
            pending += 1;
            ++nullSteps;
            return;
        }
        const Sample &x = before.x, &y = proposal.y;
        MutationStatistics& s = statistics[size_t(info.mutation)];
        ++s.proposed;
        if (info.reject != Reject::None) {
            ++s.zero;
            ++s.rejected[size_t(info.reject)];
            pending += weight(x, 1);
            return;
        }
        const double alpha = info.acceptance;
        const bool large = run.deposit_ == Deposit::Kelemen && run.mix_[size_t(info.mutation)].mutation->isLargeStep();
        pending += weight(x, 1 - alpha);
        const double proposed = weight(y, alpha + large);
        const Vec2f jump = y.splats[0].raster - x.splats[0].raster;
        s.squaredJump += alpha * double(jump.length2());
        if (!info.accepted) {
            if (proposed > 0) deposit(y, proposed);
            return;
        }
        ++s.accepted;
        deposit(x, pending);
        pending = proposed;
        const uint32_t label = featureOf(y);
        jumps += label != kNone && feature != kNone && label != feature;
        if (label != kNone) feature = label;
    }

    /// The weight of one deposit of f/π, in units of b.
    double weight(const Sample& x, double w) const {
        if (run.deposit_ == Deposit::ExpectedValues) return w;
        return w / (1 + largeStepProbability * run.normalization_ / std::exp(x.logTarget));
    }

    void deposit(const Sample& x, double w) {
        for (int i = 0; i < x.splats.size(); ++i) {
            const Splat& splat = x.splats[i];
            film.splat(splat.raster, splat.value * w);
            if (splat.feature == kNone) continue;
            const double energy = luminance(splat.value) * w;
            if (energy < FixedSum::kLargestTerm) featureEnergy[splat.feature].add(energy);
        }
    }

    /// The label of the brightest part that has one.
    static uint32_t featureOf(const Sample& x) {
        uint32_t label = kNone;
        double most = 0;
        for (int i = 0; i < x.splats.size(); ++i) {
            const double l = luminance(x.splats[i].value);
            if (x.splats[i].feature != kNone && l > most) most = l, label = x.splats[i].feature;
        }
        return label;
    }

    const ChainRun& run;
    std::unique_ptr<Target> target;
    Kernel kernel;
    Film film;
    std::vector<MutationStatistics> statistics;
    std::vector<FixedSum> featureEnergy;
    double largeStepProbability;
    uint64_t jumps = 0, nullSteps = 0;
    // Of the chain at work:
    double pending = 0;          ///< weight its current state is still to be deposited with
    uint32_t feature = kNone;
    int last = -1;
};

ChainRun::ChainRun(const RunContext& context, const ChainParameters& parameters, const PathLimits& limits, MutationMix mix, Deposit deposit,
                   const TargetMaker& makeTarget)
    : context_(context), parameters_(parameters), limits_(limits), mix_(std::move(mix)), deposit_(deposit) {
    for (int i = 0; i < context.workers; ++i) workers_.push_back(std::make_unique<Worker>(*this, makeTarget()));
}

ChainRun::~ChainRun() = default;

void ChainRun::prepare() {
    bootstrap();
    seedChains();
}

void ChainRun::bootstrap() {
    const auto run = [&](uint64_t until) {
        const uint64_t from = weights_.size();
        weights_.resize(until);
        forEachChunk(context_.workers, from, until, 256, neverStop, [&](int worker, uint64_t begin, uint64_t end) {
            Target& target = *workers_[size_t(worker)]->target;
            for (uint64_t i = begin; i < end; ++i) {
                Random random(context_.key, kBootstrapStream, i);
                const double w = target.bootstrapWeight(random);
                weights_[i] = std::isfinite(w) ? w : 0;
            }
        });
    };
    if (parameters_.bootstrap > 0) {
        run(uint64_t(parameters_.bootstrap));
    } else {
        const auto start = std::chrono::steady_clock::now();
        run(kSmallestBootstrap);
        double n = kBootstrapShare * context_.expectedUnits;
        if (context_.expectedSeconds > 0) {
            const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            const double affordable = kBootstrapShare * context_.expectedSeconds / took * double(kSmallestBootstrap);
            n = context_.expectedUnits > 0 ? std::min(n, affordable) : affordable;
        }
        run(uint64_t(std::clamp(n, double(kSmallestBootstrap), double(kLargestBootstrap))));
    }
    double sum = 0, squares = 0;
    for (double w : weights_) sum += w;
    const double n = double(weights_.size());
    normalization_ = sum / n;
    for (double w : weights_) squares += (w - normalization_) * (w - normalization_);
    normalizationStandardError_ = std::sqrt(squares / (n * (n - 1)));
    bootstrapSamples_ = weights_.size();
    if (!(sum > 0))
        fail(ExitCode::InvalidConfig, "none of {} bidirectional samples carried light to the camera: is the camera inside a wall, or the light shut off?",
             weights_.size());
}

void ChainRun::seedChains() {
    // Systematic resampling: the n-th chain starts at the sample in which the running sum passes (n + offset) · step.
    const size_t count = size_t(parameters_.chains);
    std::vector<uint64_t> source(count);
    const double step = normalization_ * double(weights_.size()) / double(count);
    double next = Random(context_.key, kResamplingStream, 0)() * step, sum = 0;
    size_t seeded = 0;
    uint64_t lastPositive = 0;
    for (uint64_t i = 0; i < weights_.size() && seeded < count; ++i) {
        sum += weights_[i];
        if (weights_[i] > 0) lastPositive = i;
        while (seeded < count && next < sum) {
            source[seeded++] = i;
            next += step;
        }
    }
    while (seeded < count) source[seeded++] = lastPositive;
    weights_ = {};

    chains_.resize(count);
    std::atomic<uint64_t> lost = 0;
    forEachChunk(context_.workers, 0, count, 16, neverStop, [&](int worker, uint64_t begin, uint64_t end) {
        Worker& w = *workers_[size_t(worker)];
        for (uint64_t c = begin; c < end; ++c) {
            chains_[c] = std::make_unique<ChainSlot>();
            Chain& chain = chains_[c]->chain;
            chain.index = uint32_t(c);
            Random random(context_.key, kBootstrapStream, source[c]);
            const double choice = Random(context_.key, kResamplingStream, c + 1)();
            if (!w.target->seed(random, choice, chain.x)) {
                ++lost;
                continue;
            }
            chain.feature = Worker::featureOf(chain.x);
            chains_[c]->trace.reserve();
            w.kernel.enter(chain);
        }
    });
    std::erase_if(chains_, [](const auto& slot) { return slot->chain.x.splats.size() == 0; });
    seedsLost_ = lost;
    if (chains_.empty()) fail(ExitCode::InvalidConfig, "no chain could be seeded");
}

void ChainRun::work(int worker, uint64_t begin, uint64_t end) {
    Worker& w = *workers_[size_t(worker)];
    const uint64_t turn = begin / chunk(), round = turn / chains_.size();
    ChainSlot& slot = *chains_[turn % chains_.size()];
    const uint64_t from = round * chunk() + begin % chunk();
    while (slot.steps.load(std::memory_order_acquire) != from) std::this_thread::yield();
    Chain& chain = slot.chain;
    w.pending = 0;
    w.feature = chain.feature;
    for (uint64_t i = begin; i < end; ++i) {
        Random random(context_.key, chain.index, chain.step);
        StepContext context{random, w.target->tracing(), limits_};
        if (i % kTimedEvery != 0) {
            w.kernel.step(chain, *w.target, context, w);
            continue;
        }
        const auto start = std::chrono::steady_clock::now();
        w.kernel.step(chain, *w.target, context, w);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (w.last >= 0) w.statistics[size_t(w.last)].seconds += seconds * double(kTimedEvery);
    }
    if (w.pending > 0) w.deposit(chain.x, w.pending);
    chain.feature = w.feature;
    if (end % chunk() == 0) slot.trace.record(chain.x, chain.feature);
    slot.steps.store(from + (end - begin), std::memory_order_release);
}

Image ChainRun::develop(uint64_t units) const {
    Film film = workers_[0]->film;
    for (size_t i = 1; i < workers_.size(); ++i) film.merge(workers_[i]->film);
    return film.develop(context_.scene.sensor->windowArea() * normalization_ / double(units));
}

uint64_t ChainRun::rays() const {
    uint64_t rays = 0;
    for (const auto& w : workers_) rays += w->target->tracing().rays();
    return rays;
}

void ChainRun::report(uint64_t units, RenderStatistics& s) const {
    s.rays = rays();
    s.samples = bootstrapSamples_;
    s.mutations = units;
    s.chains = chains_.size();
    s.normalization = normalization_;
    s.normalizationStandardError = normalizationStandardError_;
    std::vector<FixedSum> energy(context_.scene.features.names.size());
    uint64_t nullSteps = 0;
    for (const auto& w : workers_) {
        for (size_t i = 0; i < mix_.size(); ++i) {
            s.mutationStatistics[mix_[i].name].merge(w->statistics[i]);
            const uint64_t bad = w->statistics[i].rejected[size_t(Reject::NotFinite)];
            if (bad > 0) s.nonFinite["mutation " + mix_[i].name] += bad;
        }
        if (w->film.nonFinite() > 0) s.nonFinite["deposit"] += w->film.nonFinite();
        for (size_t i = 0; i < energy.size(); ++i) energy[i].add(w->featureEnergy[i]);
        s.featureJumps += w->jumps;
        nullSteps += w->nullSteps;
    }
    for (const FixedSum& e : energy) s.featureEnergy.push_back(e.value() * normalization_ / double(units));
    for (const auto& slot : chains_) s.traces.push_back(slot->trace);
    s.diagnostics["bootstrap_samples"] = bootstrapSamples_;
    s.diagnostics["null_steps"] = nullSteps;
    s.diagnostics["seeds_lost_to_rounding"] = seedsLost_;
}

}  // namespace ulam
