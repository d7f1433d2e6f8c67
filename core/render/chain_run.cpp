#include "core/render/chain_run.h"

#include "core/image/splat_queue.h"
#include "core/render/parallel.h"
#include "core/render/replay.h"
#include "core/render/state_counts.h"

#include <chrono>
#include <thread>

namespace ulam {
namespace {

// Streams of random numbers beside the chains' own, which are numbered from 0; trial chains have theirs above the first.
constexpr uint32_t kTrialStream = 0xe0000000u, kBootstrapStream = 0xf0000000u, kResamplingStream = 0xf0000001u, kPilotStream = 0xf0000003u,
                   kTrialStartStream = 0xf0000004u;
// Timing every step would cost more than a cheap step.
constexpr uint64_t kTimedEvery = 32;

// The pilot doubles from its first samples until there are enough and enough of them carried light, or until it has had
// its share of the budget.
constexpr uint64_t kFirstPilot = 1000, kPilot = 10'000, kPilotHits = 32;
constexpr double kPilotShare = 0.02;
constexpr uint64_t kTrialChains = 64;  // each makes one chunk of steps

bool neverStop(int) { return false; }

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

struct ChainRun::ChainSlot {
    template <class Archive>
    void archive(Archive& a) {
        uint64_t finished = steps;
        a(chain, trace, finished);
        steps = finished;
    }

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
          featureJumps(featureEnergy.size()),
          largeStepProbability(r.mix_.largeStepProbability()) {
        if (r.parameters_.acceptanceImages) states.emplace(film.width(), film.height());
    }

    void observe(const Chain& before, const Proposal& proposal, const StepInfo& info) override {
        last = info.mutation;
        cause = info.cause;
        if (info.mutation < 0) {
            pending += 1;
            ++nullSteps;
            return;
        }
        const Sample &x = before.x, &y = proposal.y;
        MutationStatistics& s = statistics[size_t(info.mutation)];
        ++s.proposed;
        if (states) states->add(x.splats[0].raster, info.accepted);
        if (info.reject != Reject::None) {
            ++s.zero;
            ++s.rejected[size_t(info.reject)];
            pending += weight(x, 1);
            return;
        }
        const double alpha = info.acceptance;
        const bool large = run.deposit_ == Deposit::Kelemen && run.mix_[size_t(info.mutation)].mutation->isLargeStep();
        pending += weight(x, 1 - alpha);
        const double proposed = weight(y, alpha + (large ? run.pilotNormalization_ / run.bootstrap_.mean : 0));
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
        if (label == kNone) return;
        if (feature != kNone && label != feature) ++featureJumps[label];
        feature = label;
    }

    /// The weight of one deposit of f/π, in units of b.
    double weight(const Sample& x, double w) const {
        if (run.deposit_ == Deposit::ExpectedValues) return w;
        return w / (1 + largeStepProbability * run.pilotNormalization_ / std::exp(x.logTarget));
    }

    void deposit(const Sample& x, double w) {
        for (int i = 0; i < x.splats.size(); ++i) {
            const Splat& splat = x.splats[i];
            splats.add(splat.raster, splat.value * w);
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

    void take(Worker& other) {
        film.take(other.film);
        nonFinite.take(other.nonFinite);
        if (states) states->take(*other.states);
        for (size_t i = 0; i < statistics.size(); ++i) {
            statistics[i].merge(other.statistics[i]);
            other.statistics[i] = {};
        }
        for (size_t i = 0; i < featureEnergy.size(); ++i) {
            featureEnergy[i].add(other.featureEnergy[i]);
            other.featureEnergy[i] = {};
            featureJumps[i] += std::exchange(other.featureJumps[i], 0);
        }
        nullSteps += std::exchange(other.nullSteps, 0);
    }
    template <class Archive>
    void archive(Archive& a) {
        a(film, nonFinite, statistics, featureEnergy, featureJumps, nullSteps);
        if (states) a(*states);
    }

    const ChainRun& run;
    std::unique_ptr<Target> target;
    Kernel kernel;
    Film film;
    SplatQueue splats{film};
    NonFiniteLog nonFinite;
    std::vector<MutationStatistics> statistics;
    std::vector<FixedSum> featureEnergy;
    std::vector<uint64_t> featureJumps;
    std::optional<StateCounts> states;
    double largeStepProbability;
    uint64_t nullSteps = 0;
    // Of the chain at work:
    double pending = 0;          ///< weight its current state is still to be deposited with
    uint32_t feature = kNone;
    int last = -1;
    Cause cause = Cause::None;  ///< of the last step
};

ChainRun::ChainRun(const RunContext& context, const ChainParameters& parameters, const BidirectionalOptions& options, MutationMix mix, Deposit deposit,
                   const TargetMaker& makeTarget)
    : context_(context),
      parameters_(parameters),
      options_(options),
      mix_(std::move(mix)),
      deposit_(deposit),
      pilotNumbers_(context.key, kPilotStream),
      bootstrapNumbers_(context.key, kBootstrapStream),
      pilotGoal_(kFirstPilot),
      bootstrapGoal_(uint64_t(parameters.bootstrap)) {
    for (int i = 0; i < context.workers; ++i) workers_.push_back(std::make_unique<Worker>(*this, makeTarget()));
}

ChainRun::~ChainRun() = default;

std::vector<MemoryPhase> ChainRun::memory(const RunContext& context, const ChainParameters& parameters, const PathLimits& limits) {
    constexpr double kMostPerSecond = 1e6;  // bootstrap samples of a thread
    double samples = double(parameters.bootstrap);
    if (samples == 0) {
        // A sample takes no less than a mutation, and a ray.
        const auto bound = [&](double budget) {
            if (budget > 0) samples = std::min(samples, SeedingPlan::kLargestShare * budget);
        };
        samples = SeedingPlan::kMost;
        bound(context.expectedUnits);
        bound(context.expectedRays);
        bound(context.expectedSeconds * kMostPerSecond * context.workers);
        samples = std::max(samples, SeedingPlan::kFewest) + 2 * kPilot;
    }
    const double chains = parameters.chains;
    const double turns = context.expectedUnits > 0 ? context.expectedUnits / (chains * kChunk) + 1 : ChainTrace::kMost;
    const double trace = std::min(turns, double(ChainTrace::kMost)) * sizeof(ChainTrace::Draw);
    const MemoryNeed held{fmt::format("{} chains", parameters.chains), chains * double(sizeof(ChainSlot) + ChainTrace::kMost * sizeof(ChainTrace::Draw)), "fewer chains"};
    const MemoryNeed reported{"what is reported of them", chains * (2 * sizeof(ChainTrace) + trace), "fewer chains"};
    const MemoryNeed bootstrap{fmt::format("{:.3g} bootstrap samples", samples), samples * sizeof(double) + chains * sizeof(Start), "a smaller bootstrap"};
    const double pixels = context.pixels(), film = Film::bytes(pixels, false, true) + (parameters.acceptanceImages ? StateCounts::bytes(pixels) : 0);
    // Of a chain's path only what is used is written.
    const double state = chains * (sizeof(Chain) * (limits.maxDepth + 2.0) / (kMaxDepth + 2.0) + trace);
    // Between rounds of work one film has everything.
    MemoryPhase paused{{filmsOf(1, film), held, reported}, film + state};
    if (parameters.acceptanceImages) paused.parts.push_back({"images of acceptance", 2 * pixels * sizeof(Rgb), "no acceptance_images"});
    return {{{bootstrap, held}, bootstrap.bytes}, {{filmsOf(context.workers, film), held}}, paused};
}

bool ChainRun::prepare(const StopFunction& stop) {
    if (bootstrapGoal_ == 0) {
        if (!growPilot(stop) || !planBootstrap(stop)) return false;
    }
    if (deposit_ == Deposit::Kelemen && !weigh(pilotNumbers_, std::min(kPilot, bootstrapGoal_), stop, pilot_)) return false;
    if (!weigh(bootstrapNumbers_, bootstrapGoal_, stop, weights_)) return false;
    settle();
    return true;
}

void ChainRun::settle() {
    // As many samples as a repetition takes, which is told the size of the bootstrap and needs no plan.
    if (deposit_ == Deposit::Kelemen)
        pilotNormalization_ = WeightMoments(std::span(pilot_).first(std::min({size_t(kPilot), weights_.size(), pilot_.size()}))).mean;
    pilotSamples_ = pilot_.size();
    bootstrap_ = WeightMoments(weights_);
    if (bootstrap_.mean > 0)
        seedChains();
    else if (!weights_.empty() && weights_.size() == bootstrapGoal_)  // and not stopped early
        fail(ExitCode::InvalidConfig, "none of {} bidirectional samples carried light to the camera: is the camera inside a wall, or the light shut off?",
             weights_.size());
    pilot_ = weights_ = {};
}

/// Adds weights of bidirectional samples up to the `last`; false where they were stopped before.
bool ChainRun::weigh(const BootstrapNumbers& numbers, uint64_t last, const StopFunction& stop, std::vector<double>& weights) {
    const uint64_t first = weights.size();
    if (first >= last) return true;
    weights.resize(last);
    const auto kind = &numbers == &pilotNumbers_ ? NonFiniteEvent::Kind::Pilot : NonFiniteEvent::Kind::Bootstrap;
    const uint64_t end = forEachChunk(context_.workers, first, last, 256, stop, [&](int worker, uint64_t from, uint64_t to) {
        Worker& w = *workers_[size_t(worker)];
        for (uint64_t i = from; i < to; ++i) {
            takeCause();  // of what came before
            weights[i] = numbers.with(i, [&](Random& random) { return w.target->bootstrapWeight(random); });
            if (!checkFinite(Cause::Target, weights[i])) weights[i] = 0;
            if (const Cause cause = takeCause(); cause != Cause::None) [[unlikely]]
                w.nonFinite.add({.kind = kind, .unit = i, .cause = name(cause)});
        }
    });
    weights.resize(end);
    return end == last;
}

/// Of the limit that is used up most; `units`: mutations that cost as much.
double ChainRun::fractionOfBudget(const Cost& cost, double units) const {
    auto fraction = [](double used, double expected) { return expected > 0 ? used / expected : 0; };
    return std::max({fraction(cost.seconds, context_.expectedSeconds), fraction(cost.rays, context_.expectedRays),
                     fraction(units, context_.expectedUnits)});
}

/// Until there are enough, or the pilot has had its share of the budget; false where it was stopped before.
bool ChainRun::growPilot(const StopFunction& stop) {
    for (;; pilotGoal_ *= 2) {
        const auto start = Clock::now();
        const bool complete = weigh(pilotNumbers_, pilotGoal_, stop, pilot_);
        pilotSeconds_ += secondsSince(start);
        if (!complete) return false;
        const auto hits = uint64_t(std::count_if(pilot_.begin(), pilot_.end(), [](double w) { return w > 0; }));
        if (pilotGoal_ >= kPilot && hits >= kPilotHits) return true;
        if (fractionOfBudget({pilotSeconds_, double(rays())}, double(pilotGoal_)) > kPilotShare) return true;
    }
}

/// Pilot samples and a few steps of trial chains tell how samples scatter and what samples and mutations cost. False
/// where they were stopped.
bool ChainRun::planBootstrap(const StopFunction& stop) {
    const double count = double(pilot_.size());
    const Cost sample{pilotSeconds_ / count, double(rays()) / count};
    const WeightMoments moments(pilot_);
    const auto mutation = moments.mean > 0 ? tryMutations(stop) : sample;
    if (!mutation) return false;
    const double mutationsPerSample = mutation->rays > 0 ? sample.rays / mutation->rays : 1;
    const double square = context_.scene.filter.squareIntegral();
    plan_.emplace(moments, SeedingTask{.sampleCost = fractionOfBudget(sample, mutationsPerSample),
                                       .mutationCost = fractionOfBudget(*mutation, 1),
                                       .pixels = double(workers_[0]->film.pixels()) * square * square,
                                       .chains = parameters_.chains});
    bootstrapGoal_ = plan_->samples;
    return true;
}

/// Mean cost of a mutation, from short chains that start at pilot samples and leave nothing in the image. Nothing where
/// they were stopped; their rays do not count then, since a run that goes on makes them again.
std::optional<ChainRun::Cost> ChainRun::tryMutations(const StopFunction& stop) {
    struct Blind : StepObserver {
        void observe(const Chain&, const Proposal&, const StepInfo&) override {}
    } blind;
    Random random(context_.key, kTrialStartStream, 0);
    const std::vector<Start> starts = drawStarts(pilot_, kTrialChains, random);
    std::vector<Chain> chains(kTrialChains);
    const uint64_t raysOfPilot = rays();
    auto forEachChain = [&](const auto& work) {
        const uint64_t end = forEachChunk(
            context_.workers, 0, kTrialChains, 1, stop,
            [&](int worker, uint64_t c, uint64_t) { work(*workers_[size_t(worker)], chains[c], starts[c]); });
        if (end < kTrialChains) raysBefore_ -= rays() - raysOfPilot;
        return end == kTrialChains;
    };
    std::atomic<uint64_t> started = 0;
    const bool allStarted = forEachChain([&](Worker& w, Chain& chain, const Start& start) {
        chain.index = kTrialStream + uint32_t(&chain - chains.data());
        started += startChain(w, pilotNumbers_, start, chain);
    });
    if (!allStarted) return {};
    const uint64_t raysBefore = rays();
    const auto before = Clock::now();
    const bool complete = forEachChain([&](Worker& w, Chain& chain, const Start&) {
        if (chain.x.splats.size() > 0)
            for (uint64_t i = 0; i < chunk(); ++i) step(w, chain, blind);
    });
    if (!complete) return {};
    const double steps = std::max(1.0, double(started * chunk()));
    return Cost{secondsSince(before) / steps, double(rays() - raysBefore) / steps};
}

/// False where rounding lost the start.
bool ChainRun::startChain(Worker& w, const BootstrapNumbers& numbers, const Start& start, Chain& chain) {
    if (!numbers.with(start.sample, [&](Random& random) { return w.target->seed(random, start.choice, chain.x); })) return false;
    chain.feature = Worker::featureOf(chain.x);
    w.kernel.enter(chain);
    return true;
}

void ChainRun::seedChains() {
    Random random(context_.key, kResamplingStream, 0);
    const std::vector<Start> starts = drawStarts(weights_, size_t(parameters_.chains), random);
    chains_.resize(starts.size());
    std::atomic<uint64_t> lost = 0;
    forEachChunk(context_.workers, 0, starts.size(), 16, neverStop, [&](int worker, uint64_t begin, uint64_t end) {
        for (uint64_t c = begin; c < end; ++c) {
            chains_[c] = std::make_unique<ChainSlot>();
            Chain& chain = chains_[c]->chain;
            chain.index = uint32_t(c);
            if (startChain(*workers_[size_t(worker)], bootstrapNumbers_, starts[c], chain))
                chains_[c]->trace.start(chain.x);
            else
                ++lost;
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
        for (uint64_t i = begin; i < end; ++i) {
            i % kTimedEvery == 0 ? timedStep(w, chain) : step(w, chain, w);
            if (w.cause != Cause::None) [[unlikely]] logNonFinite(w, chain, i);
        }
    } catch (...) {
        failed_ = true;
        throw;
    }
    if (w.pending > 0) w.deposit(chain.x, w.pending);
    w.splats.flush();
    chain.feature = w.feature;
    if (end % chunk() == 0) slot.trace.record(chain.x, chain.feature);
    slot.steps.store(from + (end - begin), std::memory_order_release);
}

void ChainRun::step(Worker& w, Chain& chain, StepObserver& observer) {
    Random random(context_.key, chain.index, chain.step);
    StepContext context{random, w.target->tracing(), options_.limits};
    w.kernel.step(chain, *w.target, context, observer);
}

void ChainRun::logNonFinite(Worker& w, const Chain& chain, uint64_t unit) {
    const std::string of = w.cause == Cause::Mutation && w.last >= 0 ? " " + mix_[size_t(w.last)].name : "";
    w.nonFinite.add({NonFiniteEvent::Kind::Step, unit, chain.index, chain.step, name(w.cause) + of});
}

void ChainRun::timedStep(Worker& w, Chain& chain) {
    const auto start = Clock::now();
    step(w, chain, w);
    if (w.last >= 0) w.statistics[size_t(w.last)].seconds += secondsSince(start) * double(kTimedEvery);
}

/// The first worker, which then has what all have made.
ChainRun::Worker& ChainRun::gathered() {
    Worker& first = *workers_[0];
    for (size_t i = 1; i < workers_.size(); ++i) first.take(*workers_[i]);
    return first;
}

Json ChainRun::replay(const NonFiniteEvent& event) {
    Worker& w = *workers_[0];
    if (event.kind != NonFiniteEvent::Kind::Step) {
        const bool pilot = event.kind == NonFiniteEvent::Kind::Pilot;
        Json json = {{pilot ? "pilot_sample" : "bootstrap_sample", event.unit}};
        (pilot ? pilotNumbers_ : bootstrapNumbers_).with(event.unit, [&](Random& random) {
            PrimaryVector u;
            Numbers numbers(u, random);
            const Vec2f raster = context_.scene.sensor->sampleRaster(numbers(NumberStream::Camera, 0));
            json.update(describeSample(context_.scene, options_, raster, numbers));
        });
        return json;
    }
    struct Recorder : StepObserver {
        void observe(const Chain& before, const Proposal& proposal, const StepInfo& info) override {
            if (before.step == step) json = describeStep(run.context_.scene, run.options_, run.mix_, before, proposal, info);
        }
        Recorder(const ChainRun& r, uint64_t s) : run(r), step(s) {}
        const ChainRun& run;
        uint64_t step;
        Json json;
    } recorder(*this, event.step);
    prepare(neverStop);
    const auto slot = std::find_if(chains_.begin(), chains_.end(), [&](const auto& s) { return s->chain.index == event.chain; });
    if (slot == chains_.end()) fail(ExitCode::InvalidConfig, "there is no chain {} in this run", event.chain);
    while ((*slot)->chain.step < event.step) step(w, (*slot)->chain, recorder);
    return recorder.json;
}

Image ChainRun::develop(uint64_t units) {
    return gathered().film.develop(context_.scene.sensor->windowArea() * bootstrap_.mean / double(units));
}

uint64_t ChainRun::rays() const {
    uint64_t rays = raysBefore_;
    for (const auto& w : workers_) rays += w->target->tracing().rays();
    return rays;
}

template <class Archive>
void ChainRun::archive(Archive& a) {
    uint64_t traced = rays(), chains = chains_.size();
    a(traced, pilot_, weights_, pilotGoal_, bootstrapGoal_, pilotSeconds_, plan_, bootstrap_, pilotNormalization_, pilotSamples_,
      seedsLost_, gathered(), chains);
    if (traced > rays()) raysBefore_ = traced;
    while (chains_.size() < chains) chains_.push_back(std::make_unique<ChainSlot>());
    for (auto& slot : chains_) a(*slot);
}

void ChainRun::report(uint64_t units, RenderStatistics& s) {
    s.rays = rays();
    s.samples = pilotSamples_ + bootstrap_.samples;
    s.mutations = units;
    s.chains = chains_.size();
    s.normalization = bootstrap_.mean;
    s.normalizationStandardError = bootstrap_.standardError;
    const Worker& all = gathered();
    for (size_t i = 0; i < mix_.size(); ++i) s.mutationStatistics[mix_[i].name] = all.statistics[i];
    s.nonFinite = all.nonFinite;
    s.nonFinite.count("deposit", all.film.nonFinite());
    s.featureJumps = all.featureJumps;
    for (const FixedSum& e : all.featureEnergy) s.featureEnergy.push_back(units > 0 ? e.value() * bootstrap_.mean / double(units) : 0);
    for (const auto& slot : chains_) s.traces.push_back(slot->trace);
    s.diagnostics["pilot_samples"] = pilotSamples_;
    s.diagnostics["bootstrap_samples"] = bootstrap_.samples;
    s.diagnostics["bootstrap_effective_samples"] = bootstrap_.effective;
    s.diagnostics["bootstrap_stratification"] = bootstrap_.stratification;
    if (plan_)
        s.diagnostics["seeding_plan"] = {{"expected_error", plan_->expectedError},
                                         {"wanted_std_error", SeedingPlan::kScaleError * plan_->expectedError},
                                         {"samples_for_scale", plan_->samplesForScale},
                                         {"samples_for_starts", plan_->samplesForStarts},
                                         {"samples_for_smallest_share", plan_->samplesForSmallestShare},
                                         {"samples_for_largest_share", plan_->samplesForLargestShare},
                                         {"samples", plan_->samples}};
    if (all.states) all.states->develop(s.extraImages);
    s.diagnostics["null_steps"] = all.nullSteps;
    s.diagnostics["seeds_lost_to_rounding"] = seedsLost_;
}

}  // namespace ulam
