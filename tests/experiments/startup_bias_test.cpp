// No start-up bias: chains that were drawn from few bootstrap samples and took few steps make the right image on average,
// also where the budget ends before every chain had its turn. Fixed seeds; Holm at 1e-3 over the tiles.

#include "experiments/statistics/holm.h"
#include "experiments/verify/image_audit.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

const audit::AuditScene& diffuseScene() {
    for (const auto& scene : audit::auditScenes())
        if (scene->name == "diffuse") return *scene;
    throw std::runtime_error("no audit scene is called diffuse");
}

Json withLimits(Json sampler) {
    sampler["max_depth"] = diffuseScene().limits.maxDepth;
    sampler["rr_depth"] = diffuseScene().limits.rrDepth;
    return sampler;
}

/// Many short runs against bidirectional path tracing.
void checkShortRuns(const Json& sampler, double mutations, int runs, double sharpness) {
    Budget reference, budget;
    reference.spp = 256;
    budget.mutations = mutations;
    const Scene& scene = diffuseScene().scene;
    const auto truth = verify::renderTiled(scene, withLimits({{"type", "bdpt"}}), reference, 16, 1, 1, 2);
    const auto found = verify::renderTiled(scene, withLimits(sampler), budget, runs, 1, 2, 1);
    const verify::ImageComparison c = verify::compare("short runs", found, truth);
    const auto adjusted = statistics::holmAdjusted(c.p);
    CAPTURE(c.energyShift, c.energyWidth);
    CHECK(*std::min_element(adjusted.begin(), adjusted.end()) > 1e-3);
    CHECK(c.energyHolds());
    CHECK(c.energyWidth < sharpness);
}

}  // namespace

TEST_CASE("one turn of one chain of many is unbiased") {
    checkShortRuns({{"type", "mlt"}, {"chains", 100}, {"bootstrap", 10}}, 2, 16'000, 0.02);
}

TEST_CASE("Kelemen's deposits are unbiased with a poor bootstrap") {
    checkShortRuns({{"type", "pssmlt"}, {"chains", 1}, {"bootstrap", 4}}, 64, 30'000, 0.02);
}
