#include "experiments/statistics/chains.h"

#include <algorithm>
#include <bit>
#include <boost/math/distributions/normal.hpp>
#include <boost/sort/spreadsort/integer_sort.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "core/base/error.h"
#include "experiments/statistics/moments.h"

namespace ulam::statistics {
namespace {

void requireTraces(std::span<const Trace> chains, std::size_t shortest) {
    if (chains.empty()) fail(ExitCode::InvalidConfig, "chain diagnostics: expected at least one trace, found none");
    for (const Trace& chain : chains) {
        if (chain.size() == chains.front().size() && chain.size() >= shortest) continue;
        fail(ExitCode::InvalidConfig,
             "chain diagnostics: expected traces of one length of at least {}, found {} and {}", shortest,
             chains.front().size(), chain.size());
    }
}

/// Means, variances and autocovariances (divided by n at every lag) of chains of equal length.
class Autocovariance {
public:
    explicit Autocovariance(std::span<const Trace> chains) : length_(chains.front().size()) {
        for (const Trace& chain : chains) {
            Trace centred = chain;
            means_.push_back(mean(chain));
            for (double& x : centred) x -= means_.back();
            within_ += variance(chain) / static_cast<double>(chains.size());
            centred_.push_back(std::move(centred));
        }
        const auto n = static_cast<double>(length_);
        total_ = within_ * (n - 1) / n + (chains.size() > 1 ? variance(means_) : 0);
    }

    std::size_t length() const { return length_; }
    bool isConstant() const { return total_ == 0; }

    double correlation(std::size_t lag) const {
        if (lag == 0) return 1;
        double sum = 0;
        // Quicker than inner_product, since the order of the terms is free.
        for (const Trace& chain : centred_)
            sum += std::transform_reduce(chain.begin() + static_cast<std::ptrdiff_t>(lag), chain.end(), chain.begin(), 0.0);
        const auto n = static_cast<double>(length_);
        const double covariance = sum / (n * static_cast<double>(centred_.size()));
        return 1 - (within_ * (n - 1) / n - covariance) / total_;
    }

private:
    std::size_t length_;
    std::vector<Trace> centred_;
    std::vector<double> means_;
    double within_ = 0;
    double total_ = 0;
};

/// Each chain cut into its first and second half; the middle value of an odd length is left out.
std::vector<Trace> splitInHalves(std::span<const Trace> chains) {
    std::vector<Trace> halves;
    for (const Trace& chain : chains) {
        const auto half = static_cast<std::ptrdiff_t>(chain.size() / 2);
        halves.emplace_back(chain.begin(), chain.begin() + half);
        halves.emplace_back(chain.end() - half, chain.end());
    }
    return halves;
}

/// Normal scores of ranks from 1 to `count` (Blom's 3/8).
class NormalScores {
public:
    explicit NormalScores(std::size_t count) : count_(count) {
        lower_.reserve(count / 2);
        for (std::size_t i = 0; i < count / 2; ++i) lower_.push_back(computed(static_cast<double>(i + 1)));
    }

    /// `last` draws lie below or share their value, `first` lie below: ties have their average rank.
    double operator()(std::size_t first, std::size_t last) const {
        if (last - first > 1) return computed(static_cast<double>(first + last + 1) / 2);
        if (first < lower_.size()) return lower_[first];
        return last > count_ - lower_.size() ? -lower_[count_ - last] : 0;
    }

private:
    double computed(double rank) const {
        // In double and no further: a run asks for the score of each of its draws.
        using namespace boost::math::policies;
        const boost::math::normal_distribution<double, policy<promote_double<false>>> normal;
        return boost::math::quantile(normal, (rank - 0.375) / (static_cast<double>(count_) + 0.25));
    }

    std::size_t count_;
    std::vector<double> lower_;  ///< of the lower half; the upper one is its mirror image
};

/// A value and the place in a chain that has it.
struct Draw {
    double value;
    double* place;
};

/// The draws of all chains together, by size.
std::vector<Draw> sortedDraws(std::vector<Trace>& chains) {
    std::vector<Draw> order;
    order.reserve(chains.size() * chains.front().size());
    for (Trace& chain : chains) {
        for (double& x : chain) order.push_back({x, &x});
    }
    // Bits that rise with the value. Boost's sort of floating point subtracts keys of both signs, which overflows.
    const auto key = [](const Draw& draw, unsigned shift) {
        constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
        const auto bits = std::bit_cast<std::uint64_t>(draw.value);
        return (bits & kSign ? ~bits : bits | kSign) >> shift;
    };
    boost::sort::spreadsort::integer_sort(order.begin(), order.end(), key,
                                          [](const Draw& a, const Draw& b) { return a.value < b.value; });
    return order;
}

/// Distances from the median, by size: sees chains that differ in spread only.
std::vector<Draw> folded(std::vector<Draw> order) {
    const std::size_t n = order.size();
    const double median = (order[(n - 1) / 2].value + order[n / 2].value) / 2;
    for (Draw& draw : order) draw.value = std::abs(draw.value - median);
    // What lies below the median is in falling order now, the rest in rising order.
    std::vector<Draw> below(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n / 2)), merged(n);
    std::ranges::reverse(below);
    std::ranges::merge(below, std::span(order).subspan(n / 2), merged.begin(), {}, &Draw::value, &Draw::value);
    return merged;
}

/// Writes the normal score of its rank to each draw's place.
void rankNormalise(const std::vector<Draw>& order, const NormalScores& scores) {
    for (std::size_t first = 0; first < order.size();) {
        std::size_t last = first;
        while (last < order.size() && order[last].value == order[first].value) ++last;
        const double score = scores(first, last);
        for (; first < last; ++first) *order[first].place = score;
    }
}

/// √(base + B / W) with the degenerate cases in place.
double scaleReduction(double base, double between, double within) {
    if (between == 0) return 1;
    // Of values that are all the same, the variance may be what rounding leaves.
    constexpr double kRounding = 1e-24;
    return within <= kRounding * between ? std::numeric_limits<double>::infinity() : std::sqrt(base + between / within);
}

double classicalRhat(std::span<const Trace> chains) {
    std::vector<double> means;
    double within = 0;
    for (const Trace& chain : chains) {
        means.push_back(mean(chain));
        within += variance(chain) / static_cast<double>(chains.size());
    }
    const auto n = static_cast<double>(chains.front().size());
    return scaleReduction((n - 1) / n, variance(means), within);
}

}  // namespace

double autocorrelationTime(std::span<const Trace> chains) {
    requireTraces(chains, 4);
    const Autocovariance autocovariance(chains);
    const std::size_t n = autocovariance.length();
    const auto draws = static_cast<double>(n * chains.size());
    if (autocovariance.isConstant()) return draws;
    double sum = 0;
    double previous = std::numeric_limits<double>::infinity();
    for (std::size_t lag = 0; lag + 1 < n; lag += 2) {
        const double pair = autocovariance.correlation(lag) + autocovariance.correlation(lag + 1);
        if (pair <= 0) break;
        previous = std::min(previous, pair);
        sum += previous;
    }
    return std::max(2 * sum - 1, 1 / std::log10(draws));
}

double splitRhat(std::span<const Trace> chains) {
    requireTraces(chains, 4);
    std::vector<Trace> halves = splitInHalves(chains);
    const std::vector<Draw> order = sortedDraws(halves);
    const NormalScores scores(order.size());
    rankNormalise(order, scores);
    const double bulk = classicalRhat(halves);
    rankNormalise(folded(order), scores);
    return std::max(bulk, classicalRhat(halves));
}

double nestedRhat(std::span<const Trace> chains, std::size_t chainsPerSuperchain) {
    requireTraces(chains, 1);
    if (chainsPerSuperchain == 0 || chains.size() % chainsPerSuperchain != 0 ||
        chains.size() / chainsPerSuperchain < 2) {
        fail(ExitCode::InvalidConfig, "nested R-hat: expected at least two super-chains of {} chains, found {} chains",
             chainsPerSuperchain, chains.size());
    }
    if (chainsPerSuperchain == 1 && chains.front().size() == 1) {
        fail(ExitCode::InvalidConfig, "nested R-hat: one chain of length one has no variance inside its super-chain");
    }
    std::vector<double> superMeans;
    double within = 0;
    const std::size_t count = chains.size() / chainsPerSuperchain;
    const auto superchains = static_cast<double>(count);
    for (std::size_t first = 0; first < chains.size(); first += chainsPerSuperchain) {
        std::vector<double> means;
        for (const Trace& chain : chains.subspan(first, chainsPerSuperchain)) {
            means.push_back(mean(chain));
            if (chain.size() > 1) within += variance(chain) / static_cast<double>(chains.size());
        }
        if (means.size() > 1) within += variance(means) / superchains;
        superMeans.push_back(mean(means));
    }
    return scaleReduction(1, variance(superMeans), within);
}

}  // namespace ulam::statistics
