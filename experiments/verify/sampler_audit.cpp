#include "experiments/verify/sampler_audit.h"

#include "core/base/error.h"

namespace ulam::verify {
namespace {

Budget scaled(const Budget& budget, double factor) {
    Budget b;
    if (budget.spp) b.spp = std::max(1.0, *budget.spp * factor);
    if (budget.mutations) b.mutations = std::max(1.0, *budget.mutations * factor);
    return b;
}

}  // namespace

std::string compareSampler(Json config, const audit::AuditScene& scene, const std::string& place, const AuditSettings& settings,
                           References& references, std::vector<ImageComparison>& comparisons) {
    const Work& work = settings.work;
    const bool chains = Registry<Sampler>::instance().create(JsonNode(config))->isChainSampler();
    Budget budget;
    (chains ? budget.mutations : budget.spp) = chains ? work.pathMutations : work.samplesPerPixel;
    const auto render = [&](double factor, int runs, const char* part) {
        if (chains) config["bootstrap"] = std::llround(std::max(1000.0, work.bootstrap * factor));
        return renderTiled(scene.scene, config, scaled(budget, factor), runs, settings.seed,
                           cellOf(place + part), settings.threads);
    };
    try {
        const TiledEstimate runs = preciseRuns(work, render, kPilotShare, kMostGrowth);
        if (!runs.biasLedger.empty()) return runs.biasLedger.front();
        comparisons.push_back(compare(place, runs, references(scene)));
    } catch (const Error& error) {
        // A sampler may need what an audit scene does not have.
        if (error.code() == ExitCode::InvalidConfig) return error.what();
        throw;
    }
    return {};
}

namespace {

Finding auditSamplerImages(const std::string& sampler, const AuditSettings& settings, References& references) {
    const Work& work = settings.work;
    std::vector<ImageComparison> comparisons;
    std::vector<std::string> notJudged;
    const auto& scenes = audit::auditScenes();
    for (size_t i = 0; i < scenes.size(); ++i) {
        const auto& scene = scenes[i];
        settings.progress(double(i) / double(scenes.size()), scene->name);
        const std::string why = compareSampler(samplerConfig(sampler, *scene), *scene, fmt::format("{} by {}", scene->name, sampler), settings, references, comparisons);
        if (!why.empty()) notJudged.push_back(fmt::format("not judged in {}: {}", scene->name, why));
        // Stopping early, the correction is for fewer tests: a false alarm is at most as many times likelier as there are scenes.
        if (settings.stopAtFirst && judgeImages(comparisons, work).outcome == Outcome::Rejected) break;
    }
    Finding finding = judgeImages(comparisons, work);
    if (comparisons.empty()) finding.outcome = Outcome::NotAudited, finding.summary = "no audit scene suits it";
    finding.details.insert(finding.details.end(), notJudged.begin(), notJudged.end());
    return finding;
}

}  // namespace

SubjectReport auditSampler(const std::string& sampler, const AuditSettings& settings, References& references) {
    SubjectReport report{.kind = "sampler", .name = sampler};
    report.findings.push_back(timed([&] { return auditSamplerImages(sampler, settings, references); }));
    return report;
}

}  // namespace ulam::verify
