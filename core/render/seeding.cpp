#include "core/render/seeding.h"

#include <algorithm>
#include <cmath>

namespace ulam {

BootstrapNumbers::BootstrapNumbers(RandomKey key, uint32_t stream) : key_(key), stream_(stream) {
    // Steps that no sample has.
    constexpr uint64_t kShifts = uint64_t(1) << 63;
    for (int set = 0; set < kSets; ++set) {
        Random random(key, stream, kShifts + uint64_t(set));
        std::array<double, kDimensions> shift;
        for (double& s : shift) s = random();
        sets_[size_t(set)] = KroneckerSequence<kDimensions>(shift);
    }
}

WeightMoments::WeightMoments(std::span<const double> weights) : samples(weights.size()) {
    if (weights.empty()) return;
    constexpr size_t kSets = BootstrapNumbers::kSets;
    std::array<double, kSets> set{};
    double sum = 0, squares = 0, scatter = 0;
    for (size_t i = 0; i < weights.size(); ++i) sum += weights[i], squares += weights[i] * weights[i], set[i % kSets] += weights[i];
    const double n = double(weights.size());
    mean = sum / n;
    const size_t used = std::min(kSets, weights.size());
    for (size_t s = 0; s < used; ++s) {
        const double size = std::floor((n - 1 - double(s)) / kSets) + 1;
        scatter += std::pow((set[s] - size * mean) / n, 2);
    }
    if (used > 1) standardError = std::sqrt(scatter * double(used) / double(used - 1));
    if (sum > 0) effective = sum * sum / squares;
    const double independent = (squares / n - mean * mean) / n;
    if (independent > 0) stratification = standardError * standardError / independent;
}

SeedingPlan::SeedingPlan(const WeightMoments& pilot, const SeedingTask& task) {
    // The pilot's variance has 15 degrees of freedom: in 95 % of runs the true one is below twice of it.
    constexpr double kCaution = 2;
    expectedError = std::sqrt(task.pixels * task.mutationCost);
    samplesForSmallestShare = kSmallestShare / task.sampleCost;
    samplesForLargestShare = kLargestShare / task.sampleCost;
    samplesForScale = samplesForStarts = samplesForLargestShare;  // where the pilot saw no light
    if (pilot.mean > 0) {
        const double relative = pilot.standardError / pilot.mean / (kScaleError * expectedError);
        samplesForScale = kCaution * relative * relative * double(pilot.samples);
        samplesForStarts = task.chains * double(pilot.samples) / pilot.effective;
    }
    const double wanted = std::max({samplesForScale, samplesForStarts, samplesForSmallestShare});
    samples = uint64_t(std::clamp(std::min(wanted, samplesForLargestShare), kFewest, kMost));
}

std::vector<Start> drawStarts(std::span<const double> weights, size_t count, Random& random) {
    double total = 0;
    for (const double w : weights) total += w;
    std::vector<Start> starts;
    starts.reserve(count);
    // The n-th start is where the running sum passes (n + offset) · step.
    const double step = total / double(count);
    double next = random() * step, sum = 0;
    uint64_t lastPositive = 0;
    for (uint64_t i = 0; i < weights.size() && starts.size() < count; ++i) {
        if (weights[i] > 0) lastPositive = i;
        for (; starts.size() < count && next < sum + weights[i]; next += step) starts.push_back({i, (next - sum) / weights[i]});
        sum += weights[i];
    }
    while (starts.size() < count) starts.push_back({lastPositive, 1});  // lost to rounding
    // Each start alone is drawn by weight only once their order is forgotten; without this the first chains, which get
    // the last and incomplete round of work, would all come from the beginning of the bootstrap.
    for (size_t i = count; i > 1; --i) std::swap(starts[i - 1], starts[std::min(i - 1, size_t(random() * double(i)))]);
    return starts;
}

}  // namespace ulam
