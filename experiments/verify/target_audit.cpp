#include "experiments/verify/target_audit.h"

#include "core/mcmc/audit/enumeration.h"
#include "core/mcmc/audit/subject.h"
#include "experiments/verify/sampler_audit.h"

namespace ulam::verify {
namespace {

constexpr int kColours = 10'000;
constexpr double kHomogeneity = 1e-12;

/// Colours over many magnitudes; often with dark channels.
Finding auditFunction(const Importance& target, RandomKey key) {
    Finding finding{.level = "L1", .check = "function"};
    double worst = 0;
    for (int i = 0; i < kColours; ++i) {
        Random random = audit::randomOf(key, audit::Stream::Normal, uint64_t(i));
        Spectrum f;
        for (int c = 0; c < 3; ++c) f[c] = random() < 0.3 ? 0 : std::exp(20 * (random() - 0.5));
        const double pi = target(f), factor = std::exp(20 * (random() - 0.5));
        const bool light = f.x > 0 || f.y > 0 || f.z > 0;
        if ((pi > 0) != light || !(pi >= 0) || !std::isfinite(pi)) {
            finding.outcome = Outcome::Rejected;
            if (finding.details.size() < 3)
                finding.details.push_back(fmt::format("colour {}: π({}, {}, {}) = {}", i, f.x, f.y, f.z, pi));
        }
        if (pi > 0) worst = std::max(worst, std::abs(target(f * factor) / (factor * pi) - 1));
    }
    if (!(worst <= kHomogeneity)) {
        finding.outcome = Outcome::Rejected;
        finding.details.push_back(fmt::format("π(c f) differs from c π(f) by {:.3g}", worst));
    }
    finding.statistic = worst;
    finding.samples = kColours;
    finding.summary = fmt::format("positive where light is, homogeneous to {:.2g}, on {} colours", worst, kColours);
    return finding;
}

Finding auditTargetImages(const std::string& target, const AuditSettings& settings, References& references) {
    const Work& work = settings.work;
    std::vector<ImageComparison> comparisons;
    double done = 0;
    for (const auto& scene : audit::auditScenes()) {
        if (std::find(work.aloneImages.begin(), work.aloneImages.end(), scene->name) == work.aloneImages.end()) continue;
        for (const char* sampler : {"mlt", "pssmlt"}) {
            settings.progress(done++ / (2 * double(work.aloneImages.size())), fmt::format("{} by {}", scene->name, sampler));
            Json config = samplerConfig(sampler, *scene);
            config["target"] = target;
            compareSampler(config, *scene, fmt::format("{} by {} for {}", scene->name, sampler, target), settings, references, comparisons);
        }
    }
    return judgeImages(comparisons, work);
}

}  // namespace

SubjectReport auditTarget(const std::string& target, const AuditSettings& settings, References& references) {
    SubjectReport report{.kind = "target", .name = target};
    const RandomKey key = makeKey(settings.seed, cellOf(target));
    report.findings.push_back(timed([&] { return auditFunction(*makeImportance(target), key); }));
    report.findings.push_back(timed([&] { return auditTargetImages(target, settings, references); }));
    return report;
}

SubjectReport auditKernel(const std::string& kernel) {
    SubjectReport report{.kind = "kernel", .name = kernel};
    report.findings.push_back(timed([&] {
        Finding finding{.level = "L3", .check = "enumeration", .statistic = 0};
        for (const Space space : {Space::Path, Space::Primary}) {
            const audit::Enumeration e = audit::enumerateKernel(space);
            finding.samples += e.steps;
            finding.statistic = std::max(*finding.statistic, e.residual);
            finding.numbers[space == Space::Path ? "target over paths" : "target over numbers"] = {
                {"steps", e.steps}, {"null_steps", e.nullSteps}, {"residual", e.residual}};
        }
        finding.summary = fmt::format("π P = π to {:.2g}, from {} steps that enumerate the transitions",
                                      *finding.statistic, finding.samples);
        if (!(*finding.statistic <= audit::kEnumerationResidual)) {
            finding.outcome = Outcome::Rejected;
            finding.details.push_back(fmt::format("|π P − π| may be {:.0e} at most", audit::kEnumerationResidual));
        }
        return finding;
    }));
    return report;
}

}  // namespace ulam::verify
