#include "core/render/chain_run.h"

#include "core/render/parallel.h"

#include <chrono>
#include <thread>

namespace ulam {
namespace {

// Streams of random numbers beside the chains' own, which are numbered from 0.
constexpr uint32_t kBootstrapStream = 0xf0000000u, kResamplingStream = 0xf0000001u, kShuffleStream = 0xf0000002u,
                   kPilotStream = 0xf0000003u;
// Timing every step would cost more than a cheap step.
constexpr uint64_t kTimedEvery = 32;

constexpr uint64_t kPilot = 10'000, kSmallestBootstrap = 20'000, kLargestBootstrap = 20'000'000;
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
        const double proposed = weight(y, alpha + (large ? run.pilotNormalization_ / run.normalization_ : 0));
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
        return w / (1 + largeStepProbability * run.pilotNormalization_ / std::exp(x.logTarget));
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

void ChainRun::prepare(const StopFunction& stop) {
    if (deposit_ == Deposit::Kelemen || parameters_.bootstrap == 0) pilot(stop);
    bootstrap(stop);
    seedChains();
}

/// Weights of bidirectional samples [first, last), or of as many as were made until the stop.
std::vector<double> ChainRun::weigh(uint32_t stream, uint64_t first, uint64_t last, const StopFunction& stop) {
    std::vector<double> weights(last - first);
    std::atomic<uint64_t> notFinite = 0;
    const uint64_t end = forEachChunk(context_.workers, first, last, 256, stop, [&](int worker, uint64_t from, uint64_t to) {
        Target& target = *workers_[size_t(worker)]->target;
        for (uint64_t i = from; i < to; ++i) {
            Random random(context_.key, stream, i);
            double& w = weights[i - first];
            w = target.bootstrapWeight(random);
            if (!std::isfinite(w)) w = 0, ++notFinite;
        }
    });
    weights.resize(end - first);
    bootstrapNotFinite_ += notFinite;
    return weights;
}

void ChainRun::pilot(const StopFunction& stop) {
    const auto start = std::chrono::steady_clock::now();
    const uint64_t count = parameters_.bootstrap > 0 ? std::min(kPilot, uint64_t(parameters_.bootstrap)) : kPilot;
    const std::vector<double> weights = weigh(kPilotStream, 0, count, stop);
    pilotSeconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    pilotSamples_ = weights.size();
    for (const double w : weights) pilotNormalization_ += w / double(weights.size());
}

void ChainRun::bootstrap(const StopFunction& stop) {
    uint64_t count = uint64_t(parameters_.bootstrap);
    if (count == 0) {
        double n = kBootstrapShare * context_.expectedUnits;
        if (context_.expectedSeconds > 0) {
            const double affordable = kBootstrapShare * context_.expectedSeconds / pilotSeconds_ * double(kPilot);
            n = context_.expectedUnits > 0 ? std::min(n, affordable) : affordable;
        }
        count = uint64_t(std::clamp(n, double(kSmallestBootstrap), double(kLargestBootstrap)));
    }
    weights_ = weigh(kBootstrapStream, 0, count, stop);
    double sum = 0, squares = 0;
    for (double w : weights_) sum += w;
    const double n = double(weights_.size());
    normalization_ = n > 0 ? sum / n : 0;
    for (double w : weights_) squares += (w - normalization_) * (w - normalization_);
    normalizationStandardError_ = n > 1 ? std::sqrt(squares / (n * (n - 1))) : 0;
    bootstrapSamples_ = weights_.size();
    if (!(sum > 0) && weights_.size() == count)  // and not stopped early
        fail(ExitCode::InvalidConfig, "none of {} bidirectional samples carried light to the camera: is the camera inside a wall, or the light shut off?",
             weights_.size());
}

void ChainRun::seedChains() {
    if (!(normalization_ > 0)) return;
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
    // Each chain alone is drawn by weight only once their order is forgotten; without this the first chains, which get
    // the last and incomplete round of work, would all come from the beginning of the bootstrap.
    Random shuffle(context_.key, kShuffleStream, 0);
    for (size_t i = count; i > 1; --i) std::swap(source[i - 1], source[std::min(i - 1, size_t(shuffle() * double(i)))]);

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
            chains_[c]->trace.start(chain.x);
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
    while (slot.steps.load(std::memory_order_acquire) != from) {
        if (failed_) return;  // the worker that has this chain does not come back
        std::this_thread::yield();
    }
    Chain& chain = slot.chain;
    w.pending = 0;
    w.feature = chain.feature;
    try {
        for (uint64_t i = begin; i < end; ++i) step(w, chain, i % kTimedEvery == 0);
    } catch (...) {
        failed_ = true;
        throw;
    }
    if (w.pending > 0) w.deposit(chain.x, w.pending);
    chain.feature = w.feature;
    if (end % chunk() == 0) slot.trace.record(chain.x, chain.feature);
    slot.steps.store(from + (end - begin), std::memory_order_release);
}

void ChainRun::step(Worker& w, Chain& chain, bool timed) {
    Random random(context_.key, chain.index, chain.step);
    StepContext context{random, w.target->tracing(), limits_};
    if (!timed) return w.kernel.step(chain, *w.target, context, w);
    const auto start = std::chrono::steady_clock::now();
    w.kernel.step(chain, *w.target, context, w);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (w.last >= 0) w.statistics[size_t(w.last)].seconds += seconds * double(kTimedEvery);
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
    s.samples = pilotSamples_ + bootstrapSamples_;
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
    if (bootstrapNotFinite_ > 0) s.nonFinite["bootstrap"] = bootstrapNotFinite_;
    for (const FixedSum& e : energy) s.featureEnergy.push_back(units > 0 ? e.value() * normalization_ / double(units) : 0);
    for (const auto& slot : chains_) s.traces.push_back(slot->trace);
    s.diagnostics["pilot_samples"] = pilotSamples_;
    s.diagnostics["bootstrap_samples"] = bootstrapSamples_;
    s.diagnostics["null_steps"] = nullSteps;
    s.diagnostics["seeds_lost_to_rounding"] = seedsLost_;
}

}  // namespace ulam
