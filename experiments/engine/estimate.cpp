#include "experiments/engine/estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <span>

#include "core/base/file.h"
#include "core/render/seeding.h"
#include "experiments/engine/chain_file.h"
#include "experiments/engine/reference.h"
#include "experiments/engine/replicate.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

constexpr double kTrialSeconds = 0.3;
constexpr double kFirstUnits = 2000;  // samples or mutations of the first trial
constexpr double kRaysPerUnit = 10;   // roughly, to begin with
constexpr double kUsualPilot = 10'000;  // samples, where the budget is no reason for fewer

/// A folder for one trial, gone at the end of its scope.
struct TrialFolder {
    fs::path path = fs::temp_directory_path() / temporaryName();

    ~TrialFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};

bool limitsWork(const Budget& b) {
    return b.spp || b.mutations || b.rays;
}

Budget scaled(const Budget& budget, double fraction) {
    const auto part = [&](const std::optional<double>& limit) {
        return limit ? std::optional(*limit * fraction) : std::nullopt;
    };
    return {{}, part(budget.spp), part(budget.mutations), part(budget.rays)};
}

double pixelsOf(const Task& task) {
    return double(task.scene->filmSize.cropWidth) * task.scene->filmSize.cropHeight;
}

/// Samples or mutations that the limits of work allow.
double unitsOf(const Task& task) {
    double units = std::numeric_limits<double>::infinity();
    if (task.budget.spp) units = std::min(units, *task.budget.spp * pixelsOf(task));
    if (task.budget.mutations) units = std::min(units, *task.budget.mutations);
    if (task.budget.rays) units = std::min(units, *task.budget.rays / kRaysPerUnit);
    return units;
}

/// Samples of the bootstrap at `factor` times the budget of the trial: what each reason asks for grows with the budget,
/// but for the starts, which chains need whatever it is.
double bootstrapSamples(const RenderResult& trial, const Json& parameters, double factor) {
    const Json& diagnostics = trial.statistics.diagnostics;
    if (!diagnostics.contains("seeding_plan")) return parameters.value("bootstrap", 0.0);
    const auto asked = [&](const char* reason) { return diagnostics["seeding_plan"][reason].get<double>(); };
    const double samples = std::max({factor * asked("samples_for_scale"), asked("samples_for_starts"),
                                     factor * asked("samples_for_smallest_share")});
    return std::clamp(std::min(samples, factor * asked("samples_for_largest_share")), SeedingPlan::kFewest,
                      SeedingPlan::kMost);
}

/// Of the whole budget, `factor` times that of the trial.
double extrapolatedSeconds(const RenderResult& trial, const Json& parameters, double factor) {
    const RenderStatistics& s = trial.statistics;
    if (s.chains == 0) return factor * trial.wallSeconds;
    const auto number = [&](const char* name) { return s.diagnostics.value(name, 0.0); };
    const double pilot = number("pilot_samples"), done = pilot + number("bootstrap_samples");
    const double wanted = std::min(factor * pilot, std::max(pilot, kUsualPilot)) + bootstrapSamples(trial, parameters, factor);
    return factor * (trial.wallSeconds - s.seedingSeconds) + s.seedingSeconds * wanted / std::max(1.0, done);
}

/// Draws of a chain's trace at `factor` times the turns that this one had (core/mcmc/trace.h).
double drawsAfter(const ChainTrace& trace, double factor) {
    double draws = double(trace.draws().size() * trace.stride()) * factor;
    while (draws >= ChainTrace::kMost) draws /= 2;
    return draws;
}

double bytesOf(const fs::path& folder, const Task& task, const RenderResult& trial, double factor) {
    double bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        const auto size = double(entry.file_size());
        if (entry.path().filename() == "image.exr") bytes += size * task.snapshots;
        if (entry.path().filename() != "chains.npy") bytes += size;
    }
    const auto& traces = trial.statistics.traces;
    if (traces.empty()) return bytes;
    return bytes + double(std::min(traces.size(), kKeptChains)) * drawsAfter(traces.front(), factor) * sizeof(ChainTrace::Draw);
}

/// What a task's seconds and bytes are taken to be proportional to among cells of one sampler and scene.
Cost sizeOf(const Task& task) {
    return {limitsWork(task.budget) ? unitsOf(task) : *task.budget.seconds, pixelsOf(task)};
}

}  // namespace

Cost estimateReplicate(const Task& whole, int threads) {
    Task task = whole;
    task.snapshots = 0;
    const bool work = limitsWork(whole.budget);
    double fraction = work ? std::min(1.0, kFirstUnits / unitsOf(whole)) : 1;
    for (;;) {
        if (work)
            task.budget = scaled(whole.budget, fraction);
        else
            task.budget.seconds = std::min(kTrialSeconds, *whole.budget.seconds);
        RenderOptions options;
        options.key = task.key(0);
        options.threads = threads;
        const RenderResult trial = renderTask(task, options);
        if (work && fraction < 1 && trial.wallSeconds < kTrialSeconds) {
            fraction = std::min(1.0, fraction * std::clamp(1.2 * kTrialSeconds / trial.wallSeconds, 2.0, 16.0));
            continue;
        }
        const double factor = work ? 1 / fraction : *whole.budget.seconds / *task.budget.seconds;
        const double seconds = work ? extrapolatedSeconds(trial, task.parameters, factor) : *whole.budget.seconds;
        const TrialFolder folder;
        writeReplicate(task, 0, folder.path, threads, trial);
        return {std::min(seconds, whole.budget.seconds.value_or(seconds)), bytesOf(folder.path, whole, trial, factor)};
    }
}

PlanEstimate estimatePlan(const Plan& plan, int threads) {
    PlanEstimate estimate;
    estimate.cells.resize(plan.cells.size());
    std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> alike;  // by sampler and scene's name
    for (std::size_t c = 0; c < plan.cells.size(); ++c)
        alike[{plan.cells[c].task.sampler, plan.cells[c].task.scene->name}].push_back(c);
    const double share = std::min(1.0, double(kTriedCells) / double(plan.cells.size()));
    for (auto& [kind, group] : alike) {
        // Random ones: regular steps might meet a single value of what is swept.
        std::shuffle(group.begin(), group.end(), std::mt19937_64(plan.seed));
        const auto tried = std::size_t(std::ceil(share * double(group.size())));
        Cost sum, size;  // units and pixels of the tried ones
        for (const std::size_t c : std::span(group).first(tried)) {
            const Task& task = plan.cells[c].task;
            const Cost found = estimate.cells[c] = estimateReplicate(task, threads);
            sum.seconds += found.seconds, sum.bytes += found.bytes;
            size.seconds += sizeOf(task).seconds, size.bytes += sizeOf(task).bytes;
        }
        for (const std::size_t c : std::span(group).subspan(tried)) {
            const Cost own = sizeOf(plan.cells[c].task);
            estimate.cells[c] = {sum.seconds * own.seconds / size.seconds, sum.bytes * own.bytes / size.bytes};
            if (const auto most = plan.cells[c].task.budget.seconds)
                estimate.cells[c].seconds = std::min(estimate.cells[c].seconds, *most);
        }
        estimate.tried += tried;
    }
    for (const PlannedReference& reference : plan.references) {
        const bool made = reference.spec.kind == ReferenceSpec::Kind::Sampler;
        const int missing = made ? std::max(0, reference.task.replicates - cachedParts(reference)) : 0;
        estimate.missingParts.push_back(missing);
        estimate.references.push_back(missing > 0 ? estimateReplicate(reference.task, threads) : Cost{});
    }
    return estimate;
}

Cost PlanEstimate::total(const Plan& plan) const {
    Cost sum;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        sum.seconds += cells[c].seconds * plan.cells[c].task.replicates;
        sum.bytes += cells[c].bytes * plan.cells[c].task.replicates;
    }
    for (std::size_t i = 0; i < references.size(); ++i) {
        sum.seconds += references[i].seconds * missingParts[i];
        sum.bytes += 2 * references[i].bytes;  // image and variance: the parts are removed
    }
    return sum;
}

}  // namespace ulam
