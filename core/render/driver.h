#pragma once
// Runs a sampler until its budget is spent.

#include "core/render/sampler.h"

#include <atomic>
#include <functional>
#include <optional>

namespace ulam {

/// One or more limits; the first reached ends the run. Seconds are wall time and include seeding.
struct Budget {
    std::optional<double> seconds;
    std::optional<double> spp;        ///< samples (chains: mutations) per pixel
    std::optional<double> mutations;
    std::optional<double> rays;
};

struct RenderOptions {
    Budget budget;
    RandomKey key;
    int threads = 1;
    int snapshots = 0;  ///< images at 1/2^n … 1/2 of the budget (the whole is the last one)
    /// Called between chunks, a few times a second, with the fraction of the budget used.
    std::function<void(double)> progress;
    /// Set from a signal handler: the run ends early, with what it has.
    const std::atomic<bool>* interrupt = nullptr;
};

struct RenderResult {
    Image image;
    RenderStatistics statistics;
    std::vector<Snapshot> snapshots;
    uint64_t units = 0;       ///< samples or mutations done: the work budget that repeats this image
    double wallSeconds = 0, cpuSeconds = 0;
    bool interrupted = false;
};

/// Errors: InvalidConfig if the budget does not fit the sampler or no path carries light.
RenderResult render(const Scene& scene, const Sampler& sampler, const RenderOptions& options);

}  // namespace ulam
