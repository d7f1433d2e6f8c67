#include "experiments/statistics/sign_flip.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "experiments/statistics/permutation.h"

namespace ulam::statistics {
namespace {

bool isExact(std::size_t pairs) {
    return std::exp2(static_cast<double>(pairs)) <= static_cast<double>(kExactSplits);
}

}  // namespace

void requirePairs(std::span<const double> a, std::span<const double> b) {
    if (a.size() != b.size())
        fail(ExitCode::InvalidConfig, "paired comparison: expected as many replicates on both sides, found {} and {}",
             a.size(), b.size());
}

double signFlipP(std::span<const double> a, std::span<const double> b, std::uint64_t seed) {
    requirePairs(a, b);
    if (a.empty()) fail(ExitCode::InvalidConfig, "paired comparison: expected at least one pair, found none");
    std::vector<double> differences(a.size());
    double observed = 0;
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        differences[i] = a[i] - b[i];
        observed += differences[i];
        largest += std::abs(differences[i]);
    }
    const double threshold = std::abs(observed) - 1e-10 * largest;  // ties differ by rounding
    const auto isExtreme = [&](auto isNegative) {
        double sum = 0;
        for (std::size_t i = 0; i < differences.size(); ++i) sum += isNegative(i) ? -differences[i] : differences[i];
        return std::abs(sum) >= threshold;
    };
    std::size_t extreme = 0;
    if (isExact(a.size())) {
        const std::size_t all = std::size_t{1} << a.size();
        for (std::size_t signs = 0; signs < all; ++signs)
            extreme += isExtreme([signs](std::size_t i) { return (signs >> i & 1) != 0; });
        return static_cast<double>(extreme) / static_cast<double>(all);
    }
    PhiloxStream random(seed);
    for (std::size_t k = 0; k < kRandomSplits; ++k)
        extreme += isExtreme([&random](std::size_t) { return random.index(2) != 0; });
    return static_cast<double>(extreme + 1) / static_cast<double>(kRandomSplits + 1);
}

double smallestSignFlipP(std::size_t pairs) {
    return isExact(pairs) ? std::exp2(1 - static_cast<double>(pairs)) : 1.0 / static_cast<double>(kRandomSplits + 1);
}

}  // namespace ulam::statistics
