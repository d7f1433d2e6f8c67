#include "experiments/statistics/comparison.h"

#include <algorithm>
#include <cmath>

#include "experiments/statistics/holm.h"
#include "experiments/statistics/moments.h"
#include "experiments/statistics/permutation.h"
#include "experiments/statistics/power.h"
#include "experiments/statistics/sign_flip.h"
#include "experiments/statistics/welch.h"

namespace ulam::statistics {
namespace {

bool isHeavyTailed(std::span<const double> positiveErrors) {
    std::vector<double> logs(positiveErrors.begin(), positiveErrors.end());
    for (double& x : logs) x = std::log(x);
    return variance(logs) > kHeavyTail * kHeavyTail;
}

}  // namespace

std::string_view verdictName(Verdict verdict) {
    switch (verdict) {
        case Verdict::Undecided:
            return "undecided";
        case Verdict::Better:
            return "better";
        case Verdict::Worse:
            return "worse";
    }
    return "";
}

Comparison compare(std::span<const double> sampler, std::span<const double> baseline, double referenceVariance,
                   const Design& design) {
    Comparison result;
    result.p = design.paired ? signFlipP(sampler, baseline) : permutationP(sampler, baseline);
    result.smallestP =
        design.paired ? smallestSignFlipP(sampler.size()) : smallestPermutationP(sampler.size(), baseline.size());
    const double samplerMean = mean(sampler);
    const double baselineMean = mean(baseline);
    const double smallest = std::min(std::ranges::min(sampler), std::ranges::min(baseline));
    result.referenceTooPoor =
        smallest <= 0 || referenceVariance > kReferenceShare * std::min(samplerMean, baselineMean);
    if (samplerMean > 0 && baselineMean > 0) result.ratio = samplerMean / baselineMean;
    if (design.paired)
        result.ci95 = pairedRatioInterval(sampler, baseline, design.confidence());
    else
        result.ci95 = ratioInterval(sampler, baseline, design.confidence());
    if (result.ci95) {
        const MeanEstimate log = design.paired ? logOfPairedRatio(sampler, baseline) : logOfRatio(sampler, baseline);
        result.varianceOfLog = log.varianceOfMean;
        result.degrees = log.degrees;
    }
    result.heavyTailed = smallest > 0 && (isHeavyTailed(sampler) || isHeavyTailed(baseline));
    return result;
}

void decide(std::span<Comparison> comparisons, int looks) {
    std::vector<double> p;
    p.reserve(comparisons.size());
    for (const Comparison& c : comparisons) p.push_back(c.p);
    const std::vector<double> adjusted = holmAdjusted(p);
    // What any of them has to pass where it is the clearest of its run.
    const double level = kFamilyLevel / (looks * static_cast<double>(comparisons.size()));
    for (std::size_t i = 0; i < comparisons.size(); ++i) {
        Comparison& c = comparisons[i];
        c.pAdjusted = std::min(1.0, looks * adjusted[i]);
        c.verdict = Verdict::Undecided;
        if (c.varianceOfLog > 0 && c.smallestP <= level)
            c.detectableRatio = detectableRatio(c.varianceOfLog, c.degrees, level);
        if (c.referenceTooPoor || !c.ci95 || c.pAdjusted > kFamilyLevel) continue;
        if (c.ci95->high < 1) c.verdict = Verdict::Better;
        if (c.ci95->low > 1) c.verdict = Verdict::Worse;
    }
}

std::vector<double> smallestAdjustedP(std::span<const std::pair<std::size_t, std::size_t>> replicates,
                                      const Design& design) {
    std::vector<double> p;
    p.reserve(replicates.size());
    for (const auto& [sampler, baseline] : replicates)
        p.push_back(design.paired ? smallestSignFlipP(std::min(sampler, baseline))
                                  : smallestPermutationP(sampler, baseline));
    std::vector<double> adjusted = holmAdjusted(p);
    for (double& value : adjusted) value = std::min(1.0, design.looks * value);
    return adjusted;
}

}  // namespace ulam::statistics
