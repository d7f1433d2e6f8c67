#include "experiments/statistics/moments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace ulam::statistics {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double mean(std::span<const double> values) {
    if (values.empty()) return kNaN;
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double variance(std::span<const double> values) {
    if (values.size() < 2) return kNaN;
    const double centre = mean(values);
    double sum = 0;
    for (double x : values) sum += (x - centre) * (x - centre);
    return sum / static_cast<double>(values.size() - 1);
}

double coefficientOfVariation(std::span<const double> values) {
    return std::sqrt(variance(values)) / std::abs(mean(values));
}

double trimmedMean(std::span<const double> values, double fraction) {
    const auto dropped = static_cast<std::size_t>(fraction * static_cast<double>(values.size()));
    if (dropped == 0) return mean(values);
    std::vector<double> kept(values.begin(), values.end());
    const auto end = kept.end() - static_cast<std::ptrdiff_t>(dropped);
    std::nth_element(kept.begin(), end, kept.end());
    kept.erase(end, kept.end());
    return mean(kept);
}

double quantileOfSorted(std::span<const double> sorted, double q) {
    if (sorted.empty()) return kNaN;
    const double position = q * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    const double fraction = position - static_cast<double>(below);
    // Equal neighbours need no interpolation, and infinite ones allow none (inf - inf).
    if (fraction == 0 || sorted[below] == sorted[below + 1]) return sorted[below];
    return sorted[below] + fraction * (sorted[below + 1] - sorted[below]);
}

double quantile(std::span<const double> values, double q) {
    if (values.empty()) return kNaN;
    // Only the two that are asked for have to be in their places.
    std::vector<double> sorted(values.begin(), values.end());
    const auto below = sorted.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), below, sorted.end());
    if (below + 1 != sorted.end()) std::iter_swap(below + 1, std::min_element(below + 1, sorted.end()));
    return quantileOfSorted(sorted, q);
}

}  // namespace ulam::statistics
