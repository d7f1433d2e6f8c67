#include "experiments/statistics/goodness_of_fit.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/base/error.h"

namespace ulam::statistics {
namespace {

struct Cell {
    double observed = 0;
    double expected = 0;
};

std::vector<Cell> pooled(std::vector<Cell> cells) {
    std::ranges::stable_sort(cells, {}, &Cell::expected);
    std::vector<Cell> result;
    Cell open;
    for (const Cell& cell : cells) {
        open.observed += cell.observed;
        open.expected += cell.expected;
        if (open.expected < kSmallestExpectedCount) continue;
        result.push_back(open);
        open = {};
    }
    if (result.empty()) return {open};
    // Only a remainder that never filled up is left open.
    result.back().observed += open.observed;
    result.back().expected += open.expected;
    return result;
}

/// P(√n D > x) in the limit of large n.
double kolmogorovTail(double x) {
    if (x < 0.2) return 1;  // the series below converges slowly there, and its value is 1 to 12 digits
    double sum = 0;
    double sign = 1;
    for (int k = 1; k <= 100; ++k) {
        const double term = std::exp(-2.0 * k * k * x * x);
        sum += sign * term;
        if (term < 1e-18) break;
        sign = -sign;
    }
    return std::clamp(2 * sum, 0.0, 1.0);
}

}  // namespace

ChiSquareTest chiSquareTest(std::span<const double> observed, std::span<const double> expected) {
    if (observed.size() != expected.size()) {
        fail(ExitCode::InvalidConfig, "chi-square test: expected {} cells, found {}", expected.size(), observed.size());
    }
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] == 0 && observed[i] > 0) return {std::numeric_limits<double>::infinity(), 0, 0};
        cells.push_back({observed[i], expected[i]});
    }
    cells = pooled(std::move(cells));
    ChiSquareTest test;
    if (cells.size() < 2) return test;
    for (const Cell& cell : cells) {
        test.statistic += (cell.observed - cell.expected) * (cell.observed - cell.expected) / cell.expected;
    }
    test.degrees = static_cast<double>(cells.size() - 1);
    test.p = boost::math::cdf(boost::math::complement(boost::math::chi_squared(test.degrees), test.statistic));
    return test;
}

KolmogorovSmirnovTest uniformityTest(std::span<const double> values) {
    if (values.empty()) return {};
    std::vector<double> sorted(values.begin(), values.end());
    std::ranges::sort(sorted);
    const auto n = static_cast<double>(sorted.size());
    KolmogorovSmirnovTest test;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const auto rank = static_cast<double>(i);
        test.distance = std::max({test.distance, (rank + 1) / n - sorted[i], sorted[i] - rank / n});
    }
    test.p = kolmogorovTail((std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * test.distance);
    return test;
}

}  // namespace ulam::statistics
