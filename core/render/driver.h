#pragma once
// Runs a sampler until its budget is spent.

#include "core/render/checkpoint.h"
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

/// Shows the image while it is made.
struct PreviewPlan {
    /// Called between rounds of work, which wait for it, and with the final image. It keeps at most two images.
    std::function<void(Image)> show;
    double interval = 1;  ///< seconds at least; longer where developing and showing take more than 1 % of the time
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
    /// Keeps the state in a file while it runs and where it is interrupted; the caller removes the file of a run that is
    /// finished. None: the state is lost with the process.
    std::optional<CheckpointPlan> checkpoint;
    std::optional<PreviewPlan> preview;
};

struct RenderResult {
    Image image;
    RenderStatistics statistics;
    std::vector<Snapshot> snapshots;
    uint64_t units = 0;       ///< samples or mutations done: the work budget that repeats this image
    double wallSeconds = 0, cpuSeconds = 0;  ///< of all sessions, without snapshots, checkpoints and previews
    bool interrupted = false;
    int sessions = 1;              ///< 1 + how often it was resumed
    double checkpointSeconds = 0;  ///< spent on keeping the state, in all sessions
    double previewSeconds = 0;     ///< spent on previews, in all sessions
    std::string lost;              ///< why the state could not be kept when it was interrupted; empty: it was
};

/// Errors: InvalidConfig if the budget does not fit the sampler, the memory it needs is not allowed, no path carries light, or the checkpoint is of another run.
RenderResult render(const Scene& scene, const Sampler& sampler, const RenderOptions& options);

}  // namespace ulam
