#pragma once
// Paths of bidirectional path tracing in the test scenes.

#include "core/path/bidirectional.h"
#include "core/path/factors.h"
#include "tests/support/catch.h"
#include "tests/support/path_scenes.h"

namespace ulam {

/// Short walks and early Russian roulette, so that everything happens often.
inline constexpr PathLimits kTestLimits{6, 2};

/// Runs `samples` bidirectional samples and hands every contribution with its path to
/// `visit(contribution, path, number of the sample)`.
template <class Visitor>
void forEachPath(BidirectionalSampler& sampler, uint64_t seed, int samples, Visitor&& visit) {
    const Scene& scene = sampler.tracing().scene();
    PrimaryVector u;
    Path path;
    for (int i = 0; i < samples; ++i) {
        Random random(makeKey(seed), 0, uint64_t(i));
        u.clear();
        Numbers numbers(u, random);
        const Vec2f raster = scene.sensor->sampleRaster(numbers(NumberStream::Camera, 0));
        sampler.sample(raster, numbers, [&](const Contribution& c) {
            sampler.join(c.technique, path);
            visit(c, path, i);
        });
    }
}

inline BidirectionalSampler samplerFor(const Scene& scene, TechniqueSet techniques = {},
                                       Heuristic heuristic = Heuristic::Balance) {
    return BidirectionalSampler(scene, {kTestLimits, techniques, heuristic});
}

}  // namespace ulam
