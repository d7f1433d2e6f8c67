#include "experiments/statistics/comparison.h"

#include <algorithm>
#include <cmath>

#include "experiments/statistics/holm.h"
#include "experiments/statistics/moments.h"
#include "experiments/statistics/permutation.h"

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

Comparison compare(std::span<const double> sampler, std::span<const double> baseline, double referenceVariance) {
    Comparison result;
    result.p = permutationP(sampler, baseline);
    const double samplerMean = mean(sampler);
    const double baselineMean = mean(baseline);
    const double smallest = std::min(std::ranges::min(sampler), std::ranges::min(baseline));
    result.referenceTooPoor =
        smallest <= 0 || referenceVariance > kReferenceShare * std::min(samplerMean, baselineMean);
    if (samplerMean > 0 && baselineMean > 0) result.ratio = samplerMean / baselineMean;
    result.ci95 = ratioInterval(sampler, baseline);
    result.heavyTailed = smallest > 0 && (isHeavyTailed(sampler) || isHeavyTailed(baseline));
    return result;
}

void decide(std::span<Comparison> comparisons) {
    std::vector<double> p;
    p.reserve(comparisons.size());
    for (const Comparison& c : comparisons) p.push_back(c.p);
    const std::vector<double> adjusted = holmAdjusted(p);
    for (std::size_t i = 0; i < comparisons.size(); ++i) {
        Comparison& c = comparisons[i];
        c.pAdjusted = adjusted[i];
        c.verdict = Verdict::Undecided;
        if (c.referenceTooPoor || !c.ci95 || c.pAdjusted > kFamilyLevel) continue;
        if (c.ci95->high < 1) c.verdict = Verdict::Better;
        if (c.ci95->low > 1) c.verdict = Verdict::Worse;
    }
}

std::vector<double> smallestAdjustedP(std::span<const std::pair<std::size_t, std::size_t>> replicates) {
    std::vector<double> p;
    p.reserve(replicates.size());
    for (const auto& [sampler, baseline] : replicates) p.push_back(smallestPermutationP(sampler, baseline));
    return holmAdjusted(p);
}

}  // namespace ulam::statistics
