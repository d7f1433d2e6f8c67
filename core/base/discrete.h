#pragma once
// A finite distribution: choosing an index by weight, its probability, and the way back to the random number.

#include "core/base/warp.h"

#include <span>
#include <vector>

namespace ulam {

class DiscreteDistribution {
public:
    DiscreteDistribution() = default;
    /// Weights must be non-negative with a positive sum.
    explicit DiscreteDistribution(std::span<const double> weights) : cumulative_(weights.size() + 1) {
        for (size_t i = 0; i < weights.size(); ++i) cumulative_[i + 1] = cumulative_[i] + weights[i];
        total_ = cumulative_.back();
        for (double& c : cumulative_) c /= total_;
    }

    size_t size() const { return cumulative_.empty() ? 0 : cumulative_.size() - 1; }
    double total() const { return total_; }
    double probability(size_t i) const { return cumulative_[i + 1] - cumulative_[i]; }

    /// The index whose interval holds u; u becomes its place inside that interval, again uniform.
    size_t sample(double& u) const {
        if (size() == 1) return 0;
        const auto next = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u);
        const size_t i = size_t(next - cumulative_.begin()) - 1;
        u = std::clamp((u - cumulative_[i]) / probability(i), 0.0, 0x1.fffffffffffffp-1);
        return i;
    }
    /// The number that sample() turns into (i, u).
    double invert(size_t i, double u) const { return cumulative_[i] + u * probability(i); }

private:
    std::vector<double> cumulative_;
    double total_ = 0;
};

}  // namespace ulam
