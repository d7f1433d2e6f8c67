// From primary numbers to paths and back.

#include "core/path/primary_map.h"

#include "tests/core/path/random_paths.h"
#include "tests/core/path/tolerance.h"

using namespace ulam;

TEST_CASE("numbers found for a path by any of its techniques make it again") {
    constexpr int kSamples = 3000;
    for (const PathScene& named : pathScenes()) {
        INFO(named.name);
        const Scene scene = buildScene(named.dictionary);
        BidirectionalSampler sampler = samplerFor(scene);
        Tracing tracing(scene);
        Random random(makeKey(31), 0, 0);
        // Towards the far tails of glossy lobes, numbers lie closer together than doubles do, and inversion gets lost. Chains
        // take a technique as often as the balance heuristic says: these less than once in a million.
        const double rarest = std::any_of(scene.materials.begin(), scene.materials.end(), isGlossy) ? 1e-6 : 0;
        int tried = 0, lost = 0, far = 0, moved = 0, plain = 0;
        forEachPath(sampler, 13, kSamples, [&](const Contribution& c, const Path& x, int) {
            PathFactors factors;
            if (!evaluate(scene, x, factors)) return;
            const PathDensities d = densities(scene, kTestLimits, x, factors);
            for (int s = 0; s < d.size; ++s) {
                if (!std::isfinite(d.log(s)) || d.weight(s, TechniqueSet{}, Heuristic::Balance) < rarest) continue;
                ++tried;
                INFO("path by (" << c.technique.s << ", " << c.technique.t << "), inverted for s = " << s << " of "
                                 << d.size << " vertices");
                PrimaryVector u;
                REQUIRE(invertPath(tracing, kTestLimits, {s, d.size - s}, x, random, u));
                for (int stream = 0; stream < kStreams; ++stream)
                    for (int i = 0; i < u.size(NumberStream(stream)); ++i)
                        for (const double number : u(NumberStream(stream), i)) REQUIRE((number >= 0 && number <= 1));
                Path y;
                bool same = makePath(tracing, kTestLimits, {s, d.size - s}, u, random, y);
                double distance = 0;
                for (int i = 0; same && i < x.size(); ++i) {
                    same = x[i].kind == y[i].kind && x[i].shape == y[i].shape && x[i].lobe == y[i].lobe;
                    distance = std::max(distance, double(length(x[i].position - y[i].position)));
                }
                lost += !same;
                far += same && distance > 1e3 * tracing.offsetLength();
                bool specular = false;
                for (int i = 0; i < x.size(); ++i) specular |= isDelta(x[i].lobe);
                if (same && !specular) ++plain, moved += distance > 0.5 * tracing.offsetLength();
            }
        });
        // A path that passes an object's edge within the offset of its rays (1e-5 of the scene's size), or enlarges
        // that offset by grazing reflection at a ball, may miss.
        INFO(tried << " inversions, " << lost << " lost, " << far << " far from the path");
        CHECK(tried > 2 * kSamples);
        CHECK(lost <= 5e-4 * tried);
        CHECK(far <= 1e-3 * tried);
        INFO(moved << " of " << plain << " paths without specular vertices have moved");
        CHECK(moved <= 0.05 * plain);
    }
}
