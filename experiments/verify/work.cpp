#include "experiments/verify/work.h"

#include "experiments/statistics/holm.h"

namespace ulam::verify {

Work quickWork() {
    Work w;
    w.seedSamples = 10'000, w.states = 1000;
    w.structure = 10'000, w.balance = 20'000, w.jacobian = 2500;
    w.densityStates = 6, w.density = 20'000;
    w.starts = 60'000, w.ranks = 20'000;
    w.runs = 32;
    w.bootstrap = 20'000, w.pathMutations = 64'000, w.primaryMutations = 16'384, w.samplesPerPixel = 24;
    w.energyWidth = 0.005;
    w.aloneImages = {"specular", "outdoor"}, w.mixedImages = {"specular"};
    w.partners = 3;
    w.mixingChains = 100, w.mixingSteps = 1024;
    return w;
}

Work fullWork() {
    Work w = quickWork();
    w.seedSamples *= 20, w.states *= 10;
    w.structure *= 100, w.balance *= 50, w.jacobian *= 20;
    w.densityStates *= 10, w.density *= 10;
    w.starts *= 20, w.ranks *= 20;
    w.bootstrap *= 25, w.pathMutations *= 25, w.primaryMutations *= 25, w.samplesPerPixel *= 25;
    w.energyWidth = 0.001;
    w.aloneImages = w.mixedImages = {"diffuse", "specular", "outdoor"};
    w.partners = 100;
    w.mixingSteps *= 20;
    return w;
}

uint64_t cellOf(std::string_view name) {
    uint64_t hash = 0xcbf29ce484222325ull;  // FNV-1a
    for (const char c : name) hash = (hash ^ uint8_t(c)) * 0x100000001b3ull;
    return hash;
}

const TiledEstimate& References::operator()(const audit::AuditScene& scene) {
    const auto place = made_.find(scene.name);
    if (place != made_.end()) return place->second;
    const auto render = [&](double factor, int runs, const char* part) {
        Budget budget;
        budget.spp = std::max(1.0, work_.samplesPerPixel * factor);
        return renderTiled(scene.scene, samplerConfig("bdpt", scene), budget, runs, seed_,
                           cellOf("reference " + scene.name + part), threads_);
    };
    // At least the whole work: every comparison of tiles depends on it.
    return made_[scene.name] = preciseRuns(work_, render, 1, kMostGrowth);
}

TiledEstimate preciseRuns(const Work& work, const MakeRuns& make, double leastFactor, double mostFactor) {
    constexpr int kPilotRuns = 12;
    constexpr double kSafety = 1.4;
    double factor = kPilotShare;
    int count = kPilotRuns;
    TiledEstimate runs = make(factor, count, " pilot");
    for (const char* part : {"", " again", " once more"}) {
        if (!runs.biasLedger.empty()) break;
        const double halfWidth = work.energyWidth * runs.energy.mean;
        // Half of the interval's square is the runs', the other half the reference's.
        const double deviation = halfWidth / statistics::studentQuantile(2.0 * (work.runs - 1), 1 - (1 - kEnergyConfidence) / 2);
        const double allowed = deviation * deviation / 2;
        factor = std::clamp(factor * count / work.runs * kSafety * runs.energy.varianceOfMean / allowed, leastFactor, mostFactor);
        runs = make(factor, work.runs, part), count = work.runs;
        if (runs.energy.varianceOfMean <= allowed || factor >= mostFactor) break;
    }
    return runs;
}

Json samplerConfig(const std::string& sampler, const audit::AuditScene& scene) {
    const auto& entry = Registry<Sampler>::instance().find(sampler, JsonNode());
    Json config = {{"type", sampler}};
    const auto has = [&](const char* parameter) {
        return std::any_of(entry.parameters.begin(), entry.parameters.end(),
                           [&](const ParameterInfo& p) { return p.name == parameter; });
    };
    if (has("max_depth")) config["max_depth"] = scene.limits.maxDepth;
    if (has("rr_depth")) config["rr_depth"] = scene.limits.rrDepth;
    return config;
}

Finding judgeImages(const std::vector<ImageComparison>& comparisons, const Work& work) {
    Finding finding{.level = "L5", .check = "images"};
    std::vector<double> all;
    for (const ImageComparison& c : comparisons) all.insert(all.end(), c.p.begin(), c.p.end());
    const std::vector<double> adjusted = statistics::holmAdjusted(all);
    double smallest = 1, shift = 0, width = 0;
    size_t next = 0;
    for (const ImageComparison& c : comparisons) {
        size_t rejected = 0;
        double own = 1;
        for (size_t i = 0; i < c.p.size(); ++i, ++next)
            own = std::min(own, adjusted[next]), rejected += adjusted[next] < kTileLevel;
        if (rejected > 0)
            finding.details.push_back(fmt::format("{}: {} of {} tiles and channels differ, smallest adjusted p {:.3g}",
                                                  c.place, rejected, c.p.size(), own));
        if (!c.energyHolds())
            finding.details.push_back(fmt::format("{}: energy differs by {:+.3f} % ± {:.3f} %", c.place,
                                                  100 * c.energyShift, 100 * c.energyWidth));
        if (!(c.energyWidth <= work.energyWidth))
            finding.details.push_back(fmt::format("{}: the energy interval ± {:.3f} % is wider than ± {:.3f} %",
                                                  c.place, 100 * c.energyWidth, 100 * work.energyWidth));
        smallest = std::min(smallest, own);
        if (std::abs(c.energyShift) > std::abs(shift)) shift = c.energyShift;
        width = std::max(width, c.energyWidth);
        finding.numbers[c.place] = {
            {"smallest_adjusted_p", own}, {"energy_shift", c.energyShift}, {"energy_half_width", c.energyWidth},
            {"tiles_across", c.tilesAcross}, {"p_values", c.p}};
    }
    finding.p = smallest;
    finding.statistic = shift;
    finding.samples = comparisons.size() * size_t(work.runs);
    finding.outcome = finding.details.empty() ? Outcome::Passed : Outcome::Rejected;
    finding.summary =
        fmt::format("{} comparisons of {} runs, smallest adjusted p {:.2g}, energy within {:+.2f} % (± {:.2f} %)",
                    comparisons.size(), work.runs, smallest, 100 * shift, 100 * width);
    return finding;
}

}  // namespace ulam::verify
