// Densities and weights of bidirectional path tracing against each other, and against those of the path alone.

#include "core/path/densities.h"

#include "tests/core/path/random_paths.h"
#include "tests/core/path/tolerance.h"

using namespace ulam;

namespace {

constexpr int kSamples = 3000;

const std::vector<TechniqueSet> kSets = {{},
                                         {.connect = false, .lightImage = false},
                                         {.hitLight = false, .nextEvent = false, .connect = false},
                                         {.nextEvent = false}};

}  // namespace

TEST_CASE("the weights of all techniques of a path add up to 1 and follow their heuristic") {
    for (const PathScene& named : pathScenes()) {
        INFO(named.name);
        const Scene scene = buildScene(named.dictionary);
        BidirectionalSampler sampler = samplerFor(scene);
        int paths = 0, shared = 0;
        forEachPath(sampler, 11, kSamples, [&](const Contribution&, const Path& path, int) {
            PathFactors factors;
            if (!evaluate(scene, path, factors)) return;
            const PathDensities d = densities(scene, kTestLimits, path, factors);
            ++paths;
            for (const TechniqueSet& set : kSets)
                for (const int power : {1, 2}) {
                    // In units of the largest: far off a lobe of microfacets, densities underflow.
                    double largest = -std::numeric_limits<double>::infinity(), sum = 0, total = 0;
                    int techniques = 0;
                    for (int s = 0; s < d.size; ++s)
                        if (set.contains(s, d.size - s)) largest = std::max(largest, d.log(s));
                    const auto term = [&](int s) { return std::exp(power * (d.log(s) - largest)); };
                    for (int s = 0; s < d.size; ++s)
                        if (set.contains(s, d.size - s) && std::isfinite(d.log(s))) total += term(s);
                    for (int s = 0; s < d.size; ++s) {
                        if (!set.contains(s, d.size - s) || !std::isfinite(d.log(s))) continue;
                        const double w = d.weight(s, set, power == 1 ? Heuristic::Balance : Heuristic::Power);
                        REQUIRE(w == Approx(term(s) / total).epsilon(1e-9).margin(1e-250));
                        sum += w;
                        ++techniques;
                    }
                    if (techniques > 0) REQUIRE(sum == Approx(1).epsilon(1e-12));
                    shared += techniques > 1;
                }
        });
        CHECK(paths > kSamples / 2);
        CHECK(shared > paths);
    }
}

TEST_CASE("densities and contribution of a connection are those of its path") {
    for (const PathScene& named : pathScenes()) {
        INFO(named.name);
        const Scene scene = buildScene(named.dictionary);
        BidirectionalSampler sampler = samplerFor(scene);
        int paths = 0, rough = 0;
        // The explanation is a narrow one on nearly all paths; between close vertices, glossy lobes amplify what offsets do.
        const double narrow = std::any_of(scene.materials.begin(), scene.materials.end(), isGlossy) ? 1e-2 : 3e-3;
        forEachPath(sampler, 12, kSamples, [&](const Contribution& c, const Path& path, int) {
            INFO("technique (" << c.technique.s << ", " << c.technique.t << ")");
            PathFactors factors;
            if (!evaluate(scene, path, factors)) return;
            const PathDensities own = densities(scene, kTestLimits, path, factors), &walked = sampler.densities();
            const double explained = explainedLogError(sampler.tracing(), path, factors);
            ++paths;
            rough += explained > narrow;
            REQUIRE(own.size == walked.size);
            REQUIRE(own.possible(c.technique.s));
            for (int s = 0; s < own.size; ++s) {
                REQUIRE(own.possible(s) == walked.possible(s));
                if (!own.possible(s)) continue;
                const double a = own.log(s), b = walked.log(s);
                INFO("s = " << s << ": log density " << a << ", walked " << b << ", explained difference "
                            << explained);
                REQUIRE((a == b || std::abs(a - b) <= explained));
            }
            const Spectrum ratio = factors.contribution() / std::exp(own.log(c.technique.s)),
                           value = c.value / c.weight;
            const double log = std::log(luminance(ratio) / luminance(value));
            INFO("log of f/p over the contribution: " << log << ", explained " << explained);
            REQUIRE(std::abs(log) <= explained);
            REQUIRE((ratio / luminance(ratio) - value / luminance(value)).length() <= explained);
        });
        CHECK(paths > kSamples / 2);
        CHECK(rough < 0.1 * paths);
    }
}
