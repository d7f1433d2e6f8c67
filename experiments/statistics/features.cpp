#include "experiments/statistics/features.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "experiments/statistics/holm.h"
#include "experiments/statistics/moments.h"

namespace ulam::statistics {
namespace {

/// Relative spread from which on skewness spoils Student's t.
constexpr double kSkewedSpread = 0.3;

std::optional<double> neverVisitedP(const MeanEstimate& truth, std::size_t replicates) {
    const double w = std::clamp(truth.mean - 2 * std::sqrt(truth.varianceOfMean), 0.0, 1.0);
    return std::min(1.0, 2 * std::pow(1 - w, static_cast<double>(replicates)));
}

void requireFeatures(std::size_t expected, std::size_t found) {
    if (expected == found) return;
    fail(ExitCode::InvalidConfig, "feature occupancy: expected {} features, found {}", expected, found);
}

}  // namespace

std::optional<double> skewedMeanP(std::span<const double> column, const MeanEstimate& truth) {
    const double n = static_cast<double>(column.size());
    const MeanEstimate found = estimateMean(column);
    const double variance = found.varianceOfMean * n;
    if (n < kReplicatesPerSquaredSpread * variance / (found.mean * found.mean)) return std::nullopt;
    const double welch = welchTest(found, truth).p;
    if (!(variance > kSkewedSpread * kSkewedSpread * found.mean * found.mean) || n < 3) return welch;
    double cubes = 0;
    for (const double x : column) cubes += std::pow(x - found.mean, 3);
    const double third = cubes * n / ((n - 1) * (n - 2)), difference = found.mean - truth.mean;
    MeanEstimate corrected = found;
    corrected.mean += third / (6 * variance * n) + third / (3 * variance * variance) * difference * difference;
    return std::max(welch, welchTest(corrected, truth).p);
}

std::vector<FeatureShare> featureShares(std::span<const std::vector<double>> shares,
                                        std::span<const MeanEstimate> truth) {
    if (shares.empty()) return {};
    const std::size_t features = shares.front().size();
    for (const std::vector<double>& replicate : shares) requireFeatures(features, replicate.size());
    if (!truth.empty()) requireFeatures(features, truth.size());

    std::vector<FeatureShare> result(features);
    std::vector<double> p(features, 1.0);
    std::vector<double> column(shares.size());
    for (std::size_t f = 0; f < features; ++f) {
        std::ranges::transform(shares, column.begin(), [f](const std::vector<double>& r) { return r[f]; });
        FeatureShare& feature = result[f];
        feature.share = mean(column);
        feature.ci95 = studentInterval(column);
        if (feature.ci95) {
            feature.ci95 = Interval{std::max(0.0, feature.ci95->low), std::min(1.0, feature.ci95->high)};
        }
        if (truth.empty()) continue;
        feature.truth = truth[f].mean;
        if (column.size() < 2) continue;
        const auto tested = feature.share == 0 ? neverVisitedP(truth[f], column.size()) : skewedMeanP(column, truth[f]);
        feature.judged = tested.has_value();
        p[f] = tested.value_or(1);
    }
    const std::vector<double> adjusted = holmAdjusted(p);
    for (std::size_t f = 0; f < features; ++f) {
        result[f].p = p[f];
        result[f].pAdjusted = adjusted[f];
    }
    return result;
}

}  // namespace ulam::statistics
