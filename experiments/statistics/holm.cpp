#include "experiments/statistics/holm.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ulam::statistics {
namespace {

std::vector<std::size_t> ascendingOrder(std::span<const double> p) {
    std::vector<std::size_t> order(p.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return p[i] < p[j]; });
    return order;
}

}  // namespace

std::vector<double> holmAdjusted(std::span<const double> p) {
    const std::vector<std::size_t> order = ascendingOrder(p);
    std::vector<double> adjusted(p.size());
    double largest = 0;
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        largest = std::max(largest, static_cast<double>(order.size() - rank) * p[order[rank]]);
        adjusted[order[rank]] = std::min(1.0, largest);
    }
    return adjusted;
}

std::vector<double> sidakAdjusted(std::span<const double> p) {
    std::vector<double> adjusted;
    adjusted.reserve(p.size());
    for (double x : p) adjusted.push_back(-std::expm1(static_cast<double>(p.size()) * std::log1p(-x)));
    return adjusted;
}

std::vector<double> benjaminiHochbergAdjusted(std::span<const double> p) {
    const std::vector<std::size_t> order = ascendingOrder(p);
    std::vector<double> adjusted(p.size());
    double smallest = 1;
    for (std::size_t rank = order.size(); rank-- > 0;) {
        smallest = std::min(smallest, p[order[rank]] * static_cast<double>(p.size()) / static_cast<double>(rank + 1));
        adjusted[order[rank]] = smallest;
    }
    return adjusted;
}

}  // namespace ulam::statistics
