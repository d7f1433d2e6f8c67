#include "experiments/statistics/permutation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "experiments/statistics/moments.h"

namespace ulam::statistics {
namespace {

/// Number of ways to choose group A, as a double because it is only compared and divided by.
double splitCount(std::size_t sizeA, std::size_t sizeB) {
    double count = 1;
    for (std::size_t i = 1; i <= sizeA; ++i) count = count * static_cast<double>(sizeB + i) / static_cast<double>(i);
    return std::round(count);
}

/// All values, centred, and the statistic of any split of them.
class Splits {
public:
    Splits(std::span<const double> a, std::span<const double> b) : sizeA_(a.size()), sizeB_(b.size()) {
        values_.assign(a.begin(), a.end());
        values_.insert(values_.end(), b.begin(), b.end());
        const double centre = mean(values_);
        for (double& x : values_) {
            x -= centre;
            sum_ += x;
            squares_ += x * x;
        }
        double sumA = 0;
        double squaresA = 0;
        for (std::size_t i = 0; i < sizeA_; ++i) {
            sumA += values_[i];
            squaresA += values_[i] * values_[i];
        }
        observed_ = statistic(sumA, squaresA);
    }

    double exactP() {
        visit(0, sizeA_, 0, 0);
        return static_cast<double>(extreme_) / static_cast<double>(visited_);
    }

    double randomP(PhiloxStream& random) {
        for (std::size_t k = 0; k < kRandomSplits; ++k) {
            double sumA = 0;
            double squaresA = 0;
            for (std::size_t i = 0; i < sizeA_; ++i) {
                std::swap(values_[i], values_[i + random.index(values_.size() - i)]);
                sumA += values_[i];
                squaresA += values_[i] * values_[i];
            }
            count(sumA, squaresA);
        }
        return static_cast<double>(extreme_ + 1) / static_cast<double>(visited_ + 1);
    }

private:
    /// d² / (d² + v) for a difference d of means with estimated variance v: increases with |t|, but stays bounded where
    /// v vanishes, so that ties can be told by an absolute tolerance.
    double statistic(double sumA, double squaresA) const {
        const auto n = static_cast<double>(sizeA_);
        const auto m = static_cast<double>(sizeB_);
        const double meanA = sumA / n;
        const double meanB = (sum_ - sumA) / m;
        double v = squares_;
        if (sizeA_ > 1 && sizeB_ > 1) {
            const double withinA = std::max(0.0, squaresA - n * meanA * meanA);
            const double withinB = std::max(0.0, squares_ - squaresA - m * meanB * meanB);
            v = withinA / (n * (n - 1)) + withinB / (m * (m - 1));
        }
        const double d2 = (meanA - meanB) * (meanA - meanB);
        return d2 > 0 ? d2 / (d2 + v) : 0;
    }

    void count(double sumA, double squaresA) {
        constexpr double kTie = 1e-10;
        ++visited_;
        if (statistic(sumA, squaresA) >= observed_ - kTie) ++extreme_;
    }

    /// Chooses `missing` more members of group A among the values from `next` on.
    void visit(std::size_t next, std::size_t missing, double sumA, double squaresA) {
        if (missing == 0) return count(sumA, squaresA);
        for (std::size_t i = next; i + missing <= values_.size(); ++i) {
            visit(i + 1, missing - 1, sumA + values_[i], squaresA + values_[i] * values_[i]);
        }
    }

    std::vector<double> values_;
    std::size_t sizeA_;
    std::size_t sizeB_;
    double sum_ = 0;
    double squares_ = 0;
    double observed_ = 0;
    std::size_t visited_ = 0;
    std::size_t extreme_ = 0;
};

}  // namespace

double permutationP(std::span<const double> a, std::span<const double> b, std::uint64_t seed) {
    if (a.empty() || b.empty()) {
        fail(ExitCode::InvalidConfig,
             "permutation test: expected at least one replicate in each group, found {} and {}", a.size(), b.size());
    }
    Splits splits(a, b);
    if (splitCount(a.size(), b.size()) <= static_cast<double>(kExactSplits)) return splits.exactP();
    PhiloxStream random(seed);
    return splits.randomP(random);
}

double smallestPermutationP(std::size_t sizeA, std::size_t sizeB) {
    const double count = splitCount(sizeA, sizeB);
    if (count > static_cast<double>(kExactSplits)) return 1.0 / static_cast<double>(kRandomSplits + 1);
    return (sizeA == sizeB ? 2 : 1) / count;
}

}  // namespace ulam::statistics
