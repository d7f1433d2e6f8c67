#include "core/mcmc/audit/marginals.h"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

namespace ulam::audit {
namespace {

constexpr size_t kBins = 12, kPilotBins = 48;
// Bins are joined with their neighbour until both sides are nearly normal.
constexpr double kFewestCounts = 100;
/// How far a length goes beyond the pilot's extremes, and how often at either end.
constexpr double kBeyond = 0.3, kBeyondShare = 0.005;
// Single-precision positions on a plane that is not along an axis vary by less.
constexpr double kSmallestSpread = 1e-3;

/// Edges between bins of equal shares; equal edges are one.
std::vector<double> quantileEdges(std::vector<double> values, size_t bins) {
    std::sort(values.begin(), values.end());
    std::vector<double> edges;
    for (size_t b = 0; b <= bins; ++b) {
        const double edge = values[std::min(values.size() - 1, b * values.size() / bins)];
        if (edges.empty() || edge > edges.back()) edges.push_back(edge);
    }
    return edges;
}

}  // namespace

MarginalTest::MarginalTest(const std::vector<std::string>& names, const std::vector<Coordinates>& pilot) {
    const auto room = [](Bins& b) {
        const size_t n = b.edges.size() - 1;
        b.observed.resize(n), b.sum.resize(n), b.squares.resize(n);
    };
    all_ = {.coordinate = 0, .name = "all", .edges = {0, 1}, .observed = {}, .sum = {}, .squares = {}};
    room(all_);
    for (size_t c = 0; c < names.size(); ++c) {
        std::vector<double> values;
        for (const Coordinates& row : pilot) values.push_back(row[c]);
        Bins b{.coordinate = c, .name = names[c], .edges = quantileEdges(values, kBins), .observed = {}, .sum = {}, .squares = {}};
        if (b.edges.size() < 3 || b.edges.back() - b.edges.front() < kSmallestSpread) continue;
        room(b);
        bins_.push_back(std::move(b));
    }
}

size_t MarginalTest::Bins::find(double value) const {
    const auto place = std::upper_bound(edges.begin() + 1, edges.end() - 1, value);
    return size_t(place - edges.begin()) - 1;
}

void MarginalTest::observe(const Coordinates& c) {
    ++all_.observed[0];
    for (Bins& b : bins_) ++b.observed[b.find(c[b.coordinate])];
}

void MarginalTest::expect(const Coordinates& c, double weight) {
    all_.sum[0] += weight, all_.squares[0] += weight * weight;
    for (Bins& b : bins_) {
        const size_t i = b.find(c[b.coordinate]);
        b.sum[i] += weight, b.squares[i] += weight * weight;
    }
}

std::vector<Marginal> MarginalTest::finish(uint64_t proposals, uint64_t references) const {
    const auto test = [&](const Bins& bins) {
        Marginal m;
        m.name = bins.name;
        m.edges = {bins.edges.front()};
        double observed = 0, sum = 0, squares = 0;
        const auto n = double(proposals), r = double(references);
        for (size_t i = 0; i < bins.observed.size(); ++i) {
            observed += bins.observed[i], sum += bins.sum[i], squares += bins.squares[i];
            const bool last = i + 1 == bins.observed.size();
            const double effective = squares > 0 ? sum * sum / squares : 0;
            // The sparser of both sides decides; what is left over joins the last bin.
            if (!last && (observed < kFewestCounts || effective < kFewestCounts)) continue;
            m.edges.push_back(bins.edges[i + 1]);
            m.observed.push_back(observed / n);
            m.expected.push_back(sum / r);
            m.error.push_back(std::sqrt(std::max(0.0, squares / r - sum / r * sum / r) / r));
            observed = sum = squares = 0;
        }
        for (size_t i = 0; i < m.observed.size(); ++i) {
            // Counts as independent Poisson variables, which is a little on the safe side.
            const double share = std::max(m.expected[i], m.observed[i]);
            const double variance = share / n + m.error[i] * m.error[i];
            const double d = m.observed[i] - m.expected[i];
            if (variance > 0) m.statistic += d * d / variance;
            ++m.degrees;
        }
        m.p = boost::math::gamma_q(m.degrees / 2, m.statistic / 2);
        return m;
    };
    std::vector<Marginal> marginals{test(all_)};
    for (const Bins& b : bins_) marginals.push_back(test(b));
    return marginals;
}

PilotLength::PilotLength(std::vector<double> pilot, double longest) {
    if (pilot.size() < 2) return;
    edges_ = quantileEdges(std::move(pilot), kPilotBins);
    if (edges_.size() < 2) {
        edges_.clear();
        return;
    }
    edges_.insert(edges_.begin(), edges_.front() * (1 - kBeyond));
    edges_.push_back(std::max(edges_.back(), std::min(longest, edges_.back() * (1 + kBeyond))));
}

double PilotLength::sample(double u) const {
    const size_t inner = edges_.size() - 3;
    size_t bin = 0;
    if (u >= 1 - kBeyondShare) {
        bin = inner + 1, u = (u - (1 - kBeyondShare)) / kBeyondShare;
    } else if (u < kBeyondShare) {
        u /= kBeyondShare;
    } else {
        u = (u - kBeyondShare) / (1 - 2 * kBeyondShare) * double(inner);
        bin = std::min(inner, 1 + size_t(u));
        u -= double(bin - 1);
    }
    return edges_[bin] + (edges_[bin + 1] - edges_[bin]) * u;
}

double PilotLength::pdf(double length) const {
    if (empty() || !(length > edges_.front() && length < edges_.back())) return 0;
    const auto bin = size_t(std::upper_bound(edges_.begin(), edges_.end(), length) - edges_.begin()) - 1;
    const size_t inner = edges_.size() - 3;
    const double share = bin == 0 || bin == inner + 1 ? kBeyondShare : (1 - 2 * kBeyondShare) / double(inner);
    return share / (edges_[bin + 1] - edges_[bin]);
}

}  // namespace ulam::audit
