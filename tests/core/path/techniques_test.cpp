// Every technique by itself estimates the same integral.

#include <boost/math/distributions/normal.hpp>
#include <map>

#include "tests/core/path/random_paths.h"

using namespace ulam;

namespace {

/// Moments of a sample's sum of contributions.
struct Moments {
    double sum = 0, sum2 = 0;
    int count = 0;
    void add(double x, int sample) {
        if (sample != last_) part_ = 0, last_ = sample;
        sum += x, sum2 += (part_ + x) * (part_ + x) - part_ * part_, ++count;
        part_ += x;
    }
    double mean(double n) const { return sum / n; }
    double variance(double n) const { return (sum2 / n - mean(n) * mean(n)) / n; }

private:
    double part_ = 0;
    int last_ = -1;
};

/// Paths of one kind: their length, the emitter, and the lobes. All of them can be made by the same techniques.
std::string kindOf(const Scene& scene, const Path& path) {
    std::string kind = std::to_string(scene.emitterAt(path[0])) + ":";
    for (int i = 1; i < path.length(); ++i) kind += "DRT"[int(path[i].lobe)];
    return kind;
}

/// Takes the singularities of connections away, so that every technique has a finite variance (0 where vertices touch), and
/// the peaks of glossy lobes, so that no estimate rests on a few large contributions: no BSDF counts for more than a white
/// wall's.
double damping(const Scene& scene, const Path& path) {
    PathFactors factors;
    if (!evaluate(scene, path, factors)) return 0;
    double h = 1;
    for (int i = 1; i < path.length(); ++i)
        if (!isDelta(path[i].lobe)) h *= std::min(1.0, 1 / (kPi * luminance(factors.at[size_t(i)].f)));
    for (int i = path[0].kind == Vertex::Kind::Infinite; i < path.length(); ++i) {
        const float d2 = length2(path[i].position - path[i + 1].position);
        h *= std::min(1.0, double(d2) / 0.16);
    }
    return h;
}

/// Differences of estimates as p-values, the smallest first; Šidák at level 1e-6 for each test case, fixed seeds.
class Comparisons {
public:
    void add(const Moments& a, const Moments& b, double n, const std::string& what) {
        const double z = (a.mean(n) - b.mean(n)) / std::sqrt(a.variance(n) + b.variance(n));
        const double p = 2 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::abs(z)));
        sorted_.emplace(p, fmt::format("{}: {:.5g} ± {:.2g} and {:.5g} ± {:.2g}", what, a.mean(n),
                                       std::sqrt(a.variance(n)), b.mean(n), std::sqrt(b.variance(n))));
    }
    void check(size_t fewest) const {
        REQUIRE(sorted_.size() >= fewest);
        INFO(sorted_.size() << " comparisons, the worst: " << sorted_.begin()->second);
        CHECK(sorted_.begin()->first > 1 - std::pow(1 - 1e-6, 1.0 / double(sorted_.size())));
    }

private:
    std::multimap<double, std::string> sorted_;
};

constexpr int kFewest = 400;

}  // namespace

TEST_CASE("all techniques agree on every kind of path") {
    constexpr int kSamples = 150'000;
    Comparisons comparisons;
    for (const PathScene& named : pathScenes()) {
        const Scene scene = buildScene(named.dictionary);
        BidirectionalSampler sampler = samplerFor(scene);
        std::map<std::string, std::map<int, Moments>> kinds;
        forEachPath(sampler, 14, kSamples, [&](const Contribution& c, const Path& path, int sample) {
            kinds[kindOf(scene, path)][c.technique.s].add(luminance(c.value) / c.weight * damping(scene, path), sample);
        });
        for (const auto& [kind, techniques] : kinds) {
            // The surest technique against each of the others; what a technique hardly ever meets is left out.
            const Moments* best = nullptr;
            int bestS = 0;
            for (const auto& [s, m] : techniques)
                if (m.count >= kFewest && (!best || m.variance(kSamples) < best->variance(kSamples)))
                    best = &m, bestS = s;
            for (const auto& [s, m] : techniques)
                if (best && s != bestS && m.count >= kFewest)
                    comparisons.add(m, *best, kSamples, fmt::format("{} {} s = {} and {}", named.name, kind, s, bestS));
        }
    }
    comparisons.check(150);
}

TEST_CASE("all sets of techniques and both heuristics agree on every kind of path") {
    constexpr int kSamples = 60'000;
    const std::vector<TechniqueSet> sets = {
        {}, {.connect = false, .lightImage = false}, {.nextEvent = false, .lightImage = false}, {.hitLight = false}};
    Comparisons comparisons;
    for (const PathScene& named : pathScenes()) {
        const Scene scene = buildScene(named.dictionary);
        std::vector<std::map<std::string, Moments>> estimates;
        for (const Heuristic heuristic : {Heuristic::Balance, Heuristic::Power})
            for (const TechniqueSet& set : sets) {
                BidirectionalSampler sampler = samplerFor(scene, set, heuristic);
                auto& kinds = estimates.emplace_back();
                forEachPath(sampler, 15 + estimates.size(), kSamples,
                            [&](const Contribution& c, const Path& path, int sample) {
                                kinds[kindOf(scene, path)].add(luminance(c.value) * damping(scene, path), sample);
                            });
            }
        for (size_t i = 1; i < estimates.size(); ++i)
            for (const auto& [kind, m] : estimates[i])
                if (m.count >= kFewest && estimates[0][kind].count >= kFewest)
                    comparisons.add(m, estimates[0][kind], kSamples,
                                    fmt::format("{} {} set {} and 0", named.name, kind, i));
    }
    comparisons.check(150);
}
