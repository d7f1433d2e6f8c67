#include "core/render/driver.h"

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
        run_ = sampler.start({scene, options.key, options.threads, std::isfinite(units) ? units : 0, b.seconds.value_or(0), b.rays.value_or(0)});
    }

    RenderResult execute() {
        RenderResult result;
        start_ = Clock::now();
        const double cpu = cpuSeconds();
        run_->prepare(stopAt(options_.budget.seconds.value_or(std::numeric_limits<double>::infinity()), seeded_));
        const double seeding = seconds();
        const uint64_t seedingRays = run_->rays();
        for (int n = options_.snapshots; n >= 0 && !stopped_; --n) {
            const double fraction = std::ldexp(1.0, -n);
            advance(fraction);
            if (n > 0 && !stopped_) {
                RenderStatistics s;
                const double time = seconds();
                run_->report(units_, s);
                result.snapshots.push_back({fraction, time - developing_, s.rays, s.samples, s.mutations, run_->develop(units_)});
                developing_ += seconds() - time;
            }
        }
        result.wallSeconds = seconds() - developing_;
        result.cpuSeconds = cpuSeconds() - cpu;
        result.interrupted = stopped_;
        result.units = units_;
        result.image = run_->develop(units_);
        run_->report(units_, result.statistics);
        result.statistics.biasLedger = substitutions_;
        result.statistics.biasLedger.insert(result.statistics.biasLedger.end(), run_->biasLedger().begin(), run_->biasLedger().end());
        result.statistics.seedingSeconds = seeding;
        result.statistics.seedingRays = seedingRays;
        return result;
    }

private:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    /// Goes on to a fraction of every limit. Taking the snapshots is not the renderer's work: that time is not counted.
    void advance(double fraction) {
        const Budget& b = options_.budget;
        uint64_t limit = unitLimit_;
        if (limit != kUnlimited) limit = fraction < 1 ? uint64_t(std::llround(double(limit) * fraction)) : limit;
        const double deadline = b.seconds ? *b.seconds * fraction + developing_ : std::numeric_limits<double>::infinity();
        if (!b.rays) return doUnits(limit, deadline);
        while (units_ < limit && seconds() < deadline && double(run_->rays()) < *b.rays * fraction && !stopped_)
            doUnits(std::min(limit, units_ + kChunksPerRayRound * run_->chunk()), deadline);
    }

    /// Hands out chunks in order until the limit or the deadline; what is done afterwards is exactly [0, units_).
    void doUnits(uint64_t limit, double deadline) {
        std::atomic<uint64_t> done = units_;
        units_ = forEachChunk(options_.threads, units_, limit, run_->chunk(), stopAt(deadline, done),
                              [&](int worker, uint64_t begin, uint64_t end) {
                                  run_->work(worker, begin, end);
                                  done.fetch_add(end - begin, std::memory_order_relaxed);
                              });
    }

    /// Stops at a signal and at the deadline; reports progress on the way. `done` must outlive it.
    StopFunction stopAt(double deadline, const std::atomic<uint64_t>& done) {
        return [this, deadline, &done](int worker) {
            if (options_.interrupt && options_.interrupt->load(std::memory_order_relaxed)) stopped_ = true;
            const double now = seconds();
            report(worker, now, done.load(std::memory_order_relaxed));
            return stopped_ || now >= deadline;
        };
    }

    void report(int worker, double now, uint64_t done) {
        if (worker != 0 || !options_.progress || now - lastReport_ < 0.2) return;
        lastReport_ = now;
        const Budget& b = options_.budget;
        double fraction = 0;
        if (b.seconds) fraction = std::max(fraction, (now - developing_) / *b.seconds);
        if (unitLimit_ != kUnlimited) fraction = std::max(fraction, double(done) / double(unitLimit_));
        options_.progress(std::min(1.0, fraction));
    }

    const RenderOptions& options_;
    const std::vector<std::string>& substitutions_;
    double pixels_;
    std::unique_ptr<SamplerRun> run_;
    uint64_t unitLimit_ = kUnlimited, units_ = 0;
    Clock::time_point start_;
    double developing_ = 0, lastReport_ = 0;
    std::atomic<bool> stopped_ = false;
    const std::atomic<uint64_t> seeded_ = 0;  ///< units done while seeding: none
};

}  // namespace

RenderResult render(const Scene& scene, const Sampler& sampler, const RenderOptions& options) {
    return Driver(scene, sampler, options).execute();
}

}  // namespace ulam
