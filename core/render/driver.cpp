#include "core/render/driver.h"

#include "core/base/error.h"
#include "core/render/parallel.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>

namespace ulam {
namespace {

using Clock = std::chrono::steady_clock;

double cpuSeconds() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();
// Rays are counted between rounds of this many chunks, whatever the number of threads: so the stop is deterministic.
constexpr uint64_t kChunksPerRayRound = 32;
// Of the time, what checkpoints and what previews may add.
constexpr double kLargestShare = 0.01;

class Driver {
public:
    Driver(const Scene& scene, const Sampler& sampler, const RenderOptions& options)
        : options_(options), substitutions_(scene.substitutions), pixels_(double(scene.sensor->width()) * scene.sensor->height()) {
        const Budget& b = options.budget;
        if (!b.seconds && !b.spp && !b.mutations && !b.rays) fail(ExitCode::Usage, "a render needs a budget: time, spp, mutations or rays");
        if (b.mutations && !sampler.isChainSampler()) fail(ExitCode::InvalidConfig, "a budget of mutations needs a sampler with Markov chains");
        double units = std::numeric_limits<double>::infinity();
        if (b.spp) units = std::min(units, *b.spp * pixels_);
        if (b.mutations) units = std::min(units, *b.mutations);
        unitLimit_ = std::isfinite(units) ? uint64_t(std::llround(std::max(1.0, units))) : kUnlimited;
        const RunContext context{scene, options.key, options.threads, std::isfinite(units) ? units : 0, b.seconds.value_or(0), b.rays.value_or(0)};
        requireMemoryOf(sampler.memory(context), scene);
        run_ = sampler.start(context);
    }

    RenderResult execute() {
        const auto& plan = options_.checkpoint;
        if (plan && plan->resume != Resume::No && std::filesystem::exists(plan->file)) restore(*plan);
        plannedCheckpoint_ = workSeconds() + checkpointInterval();
        prepare();
        if (options_.preview) plannedPreview_ = workSeconds() + options_.preview->interval;
        while (!stopped_) {
            const int n = options_.snapshots - int(result_.snapshots.size());
            const double fraction = std::ldexp(1.0, -n);
            advance(fraction);
            if (n == 0 || stopped_) break;
            const double time = workSeconds();
            aside([&] {
                RenderStatistics s;
                run_->report(units_, s);
                result_.snapshots.push_back({fraction, time, s.rays, s.samples, s.mutations, run_->develop(units_)});
            });
        }
        result_.wallSeconds = workSeconds();
        result_.cpuSeconds = cpuSeconds() - cpuStart_;
        result_.interrupted = stopped_;
        result_.units = units_;
        if (stopped_ && options_.checkpoint) result_.lost = keepState();
        result_.image = run_->develop(units_);
        if (options_.preview) options_.preview->show(result_.image);
        run_->report(units_, result_.statistics);
        result_.statistics.biasLedger = substitutions_;
        result_.statistics.biasLedger.insert(result_.statistics.biasLedger.end(), run_->biasLedger().begin(), run_->biasLedger().end());
        if (const uint64_t pixels = result_.statistics.unsampledPixels; pixels > 0)
            result_.statistics.biasLedger.push_back(
                fmt::format("{} of {:.0f} pixels have no sample and are black", pixels, pixels_));
        result_.statistics.seedingSeconds = seedingSeconds_;
        result_.statistics.seedingRays = seedingRays_;
        return std::move(result_);
    }

private:
    /// Of the render itself: without snapshots, checkpoints and previews, with earlier sessions.
    double workSeconds() const { return std::chrono::duration<double>(Clock::now() - start_).count() - notWork_; }

    /// Does what is not the render's own work; returns the seconds it took.
    template <class Action>
    double aside(const Action& action) {
        const double time = workSeconds(), cpu = cpuSeconds();
        action();
        const double spent = workSeconds() - time;
        notWork_ += spent;
        cpuStart_ += cpuSeconds() - cpu;
        return spent;
    }

    double timeLimit() const { return options_.budget.seconds.value_or(std::numeric_limits<double>::infinity()); }

    /// Adds to each of the run's phases what is the driver's.
    void requireMemoryOf(std::vector<MemoryPhase> phases, const Scene& scene) {
        if (phases.empty()) phases.emplace_back();
        constexpr double kCounters = 1 << 20;  // in a state, beside what is large
        const double image = pixels_ * sizeof(Rgb), snapshots = options_.snapshots * image;
        for (MemoryPhase& phase : phases) {
            phase.parts.push_back({options_.snapshots > 0 ? fmt::format("the image and {} snapshots", options_.snapshots) : "the image", image + snapshots, "a smaller film or fewer snapshots"});
            // One is made, one waits and one is on its way.
            if (options_.preview) phase.parts.push_back({"the images of a viewer", 3 * image, "a smaller film or no viewer"});
            phase.state += snapshots + kCounters;
            if (options_.checkpoint) phase.parts.push_back({"a checkpoint while it is written", phase.state, "--checkpoint 0"});
            stateBytes_ = std::max(stateBytes_, size_t(phase.state));
        }
        const auto largest = std::ranges::max_element(phases, {}, [](const MemoryPhase& phase) { return totalBytes(phase.parts); });
        requireMemory("the render", scene.memory(), largest->parts);
    }

    void prepare() {
        if (prepared_) return;
        while (!run_->prepare(stopAt(timeLimit(), seeded_))) {
            if (stopped_) return;
            if (workSeconds() >= timeLimit()) {
                run_->settle();
                break;
            }
            pause();
        }
        prepared_ = true;
        seedingSeconds_ = workSeconds();
        seedingRays_ = run_->rays();
    }

    /// Goes on to a fraction of every limit.
    void advance(double fraction) {
        const Budget& b = options_.budget;
        uint64_t limit = unitLimit_;
        if (limit != kUnlimited) limit = fraction < 1 ? uint64_t(std::llround(double(limit) * fraction)) : limit;
        const double deadline = timeLimit() * fraction;
        if (!b.rays) return doUnits(limit, deadline);
        const uint64_t round = kChunksPerRayRound * run_->chunk();
        // A session that ended inside a round has done a part of it: the round comes first.
        const auto raysAreLeft = [&] { return units_ % round != 0 || double(run_->rays()) < *b.rays * fraction; };
        while (units_ < limit && workSeconds() < deadline && !stopped_ && raysAreLeft())
            doUnits(std::min(limit, (units_ / round + 1) * round), deadline);
    }

    /// Hands out chunks in order until the limit or the deadline, with pauses; what is done afterwards is
    /// exactly [0, units_).
    void doUnits(uint64_t limit, double deadline) {
        for (;;) {
            std::atomic<uint64_t> done = units_;
            units_ = forEachChunk(options_.threads, units_, limit, run_->chunk(), stopAt(deadline, done),
                                  [&](int worker, uint64_t begin, uint64_t end) {
                                      run_->work(worker, begin, end);
                                      done.fetch_add(end - begin, std::memory_order_relaxed);
                                  });
            if (units_ >= limit || stopped_ || workSeconds() >= deadline) return;
            pause();
        }
    }

    /// Stops at a signal, at the deadline and when something is due in a pause; reports progress on the way. `done` must outlive it.
    StopFunction stopAt(double deadline, const std::atomic<uint64_t>& done) {
        return [this, deadline, &done](int worker) {
            if (options_.interrupt && options_.interrupt->load(std::memory_order_relaxed)) stopped_ = true;
            const double now = workSeconds();
            report(worker, now, done.load(std::memory_order_relaxed));
            return stopped_ || now >= deadline || now >= std::min(plannedCheckpoint_, plannedPreview_);
        };
    }

    /// Between rounds of work: what is due.
    void pause() {
        if (workSeconds() >= plannedCheckpoint_) checkpoint();
        if (workSeconds() >= plannedPreview_) preview();
    }

    double checkpointInterval() const { return options_.checkpoint ? options_.checkpoint->interval : std::numeric_limits<double>::infinity(); }

    void checkpoint() {
        const double before = result_.checkpointSeconds;
        if (const std::string trouble = keepState(); !trouble.empty()) options_.checkpoint->warn(trouble);
        plannedCheckpoint_ = workSeconds() + std::max(checkpointInterval(), (result_.checkpointSeconds - before) / kLargestShare);
    }

    void preview() {
        double spent = 0;
        if (units_ > 0) spent = aside([&] { options_.preview->show(run_->develop(units_)); });
        result_.previewSeconds += spent;
        plannedPreview_ = workSeconds() + std::max(options_.preview->interval, spent / kLargestShare);
    }

    /// What went wrong, or nothing.
    std::string keepState() {
        std::string trouble;
        result_.checkpointSeconds += aside([&] {
            try {
                ByteWriter state;
                state.text.reserve(stateBytes_);  // at once: growing, it would be there twice for a while
                archive(state);
                run_->save(state);
                writeCheckpoint(*options_.checkpoint, state.text);
            } catch (const Error& error) {
                trouble = error.what();
            }
        });
        return trouble;
    }

    void restore(const CheckpointPlan& plan) {
        std::string state;
        try {
            state = readCheckpoint(plan);
        } catch (const Error&) {
            if (plan.resume == Resume::IfUsable) return;
            throw;
        }
        ByteReader reader(state);
        archive(reader);
        run_->restore(reader);
        ++result_.sessions;
    }

    template <class Archive>
    void archive(Archive& a) {
        double wall = workSeconds(), cpu = cpuSeconds() - cpuStart_;
        a(prepared_, units_, wall, cpu, seedingSeconds_, seedingRays_, result_.snapshots, result_.sessions, result_.checkpointSeconds,
          result_.previewSeconds);
        notWork_ += workSeconds() - wall;
        cpuStart_ = cpuSeconds() - cpu;
    }

    void report(int worker, double now, uint64_t done) {
        if (worker != 0 || !options_.progress || now - lastReport_ < 0.2) return;
        lastReport_ = now;
        const Budget& b = options_.budget;
        double fraction = 0;
        if (b.seconds) fraction = std::max(fraction, now / *b.seconds);
        if (unitLimit_ != kUnlimited) fraction = std::max(fraction, double(done) / double(unitLimit_));
        options_.progress(std::min(1.0, fraction));
    }

    const RenderOptions& options_;
    const std::vector<std::string>& substitutions_;
    double pixels_;
    std::unique_ptr<SamplerRun> run_;
    uint64_t unitLimit_ = kUnlimited, units_ = 0;
    bool prepared_ = false;
    RenderResult result_;
    const Clock::time_point start_ = Clock::now();
    double cpuStart_ = cpuSeconds();
    double notWork_ = 0;  ///< seconds since start_ that are not the render's; negative where earlier sessions worked longer
    double seedingSeconds_ = 0;
    uint64_t seedingRays_ = 0;
    size_t stateBytes_ = 0;  ///< of a checkpoint, at most, as far as the sampler says
    double plannedCheckpoint_ = 0, plannedPreview_ = std::numeric_limits<double>::infinity(), lastReport_ = 0;
    std::atomic<bool> stopped_ = false;
    const std::atomic<uint64_t> seeded_ = 0;  ///< units done while seeding: none
};

}  // namespace

RenderResult render(const Scene& scene, const Sampler& sampler, const RenderOptions& options) {
    return Driver(scene, sampler, options).execute();
}

}  // namespace ulam
