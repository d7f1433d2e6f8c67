#include "experiments/engine/cell_errors.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/image/metrics.h"
#include "experiments/engine/replicate.h"
#include "experiments/engine/run.h"

namespace ulam {

namespace {

/// Of a debiased metric. The same for every image: the reference is compared with itself.
double subtracted(const Metric& metric, const Reference& reference) {
    return metric.evaluate(reference.image, reference.image) -
           metric.evaluate(reference.image, reference.image, &reference.variance);
}

const Metric& judge(const Plan& plan) {
    const Metric& primary = findMetric(plan.metrics.front());
    return primary.debiased ? primary : findMetric("relmse");
}

}  // namespace

double referenceVariance(const Plan& plan, const Reference& reference) {
    return subtracted(findMetric(plan.metrics.front()), reference);
}

double judgingError(const Plan& plan, const Reference& reference, const Image& image) {
    return judge(plan).evaluate(image, reference.image, &reference.variance);
}

double shareOfReference(const Plan& plan, const Reference& reference, double meanJudgingError) {
    const double variance = subtracted(judge(plan), reference);
    if (variance == 0) return 0;
    return meanJudgingError > 0 ? variance / meanJudgingError : std::numeric_limits<double>::infinity();
}

bool isTooPoor(double referenceShare) {
    return referenceShare > statistics::kReferenceShare;
}

CellErrors cellErrors(const Plan& plan, const Cell& cell, const Reference& reference,
                      const std::filesystem::path& runDir) {
    const Metric& primary = findMetric(plan.metrics.front());
    CellErrors found;
    found.referenceVariance = referenceVariance(plan, reference);
    found.halvesAgree = reference.halvesAgree;
    double judged = 0;
    for (int r = 0; r < cell.task.replicates; ++r) {
        const auto finished = finishedReplicate(cell.task, r, cellFolder(runDir, cell));
        if (!finished) continue;
        found.replicates.push_back(r);
        found.errors.push_back(primary.evaluate(finished->image, reference.image, &reference.variance));
        judged += judgingError(plan, reference, finished->image);
    }
    if (!found.errors.empty())
        found.referenceShare = shareOfReference(plan, reference, judged / static_cast<double>(found.errors.size()));
    return found;
}

ComparedReplicates comparedReplicates(const statistics::Design& design, const CellErrors& sampler,
                                      const CellErrors& baseline) {
    ComparedReplicates compared;
    if (!design.paired) {
        compared.sampler.resize(sampler.errors.size());
        compared.baseline.resize(baseline.errors.size());
        std::iota(compared.sampler.begin(), compared.sampler.end(), std::size_t{0});
        std::iota(compared.baseline.begin(), compared.baseline.end(), std::size_t{0});
        return compared;
    }
    for (std::size_t i = 0; i < sampler.replicates.size(); ++i) {
        const auto partner = std::ranges::lower_bound(baseline.replicates, sampler.replicates[i]);
        if (partner == baseline.replicates.end() || *partner != sampler.replicates[i]) continue;
        compared.sampler.push_back(i);
        compared.baseline.push_back(static_cast<std::size_t>(partner - baseline.replicates.begin()));
    }
    return compared;
}

std::vector<DecidedComparison> decideComparisons(const Plan& plan, const std::vector<const CellErrors*>& cells) {
    std::vector<DecidedComparison> decided;
    std::vector<statistics::Comparison> family;
    for (const PlannedComparison& planned : plan.comparisons) {
        const CellErrors &sampler = *cells[planned.cell], &baseline = *cells[planned.baseline];
        ComparedReplicates replicates = comparedReplicates(plan.design, sampler, baseline);
        if (replicates.empty()) continue;
        family.push_back(statistics::compare(pick(sampler.errors, replicates.sampler),
                                             pick(baseline.errors, replicates.baseline), sampler.referenceVariance,
                                             plan.design));
        if (!sampler.halvesAgree || isTooPoor(std::max(sampler.referenceShare, baseline.referenceShare)))
            family.back().referenceTooPoor = true;
        decided.push_back({planned, std::move(replicates), {}});
    }
    statistics::decide(family, plan.design.looks);
    for (std::size_t i = 0; i < decided.size(); ++i) decided[i].result = family[i];
    return decided;
}

}  // namespace ulam
