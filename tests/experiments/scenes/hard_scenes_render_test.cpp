// The hard-scene library as images: small renders with fixed seeds.

#include "experiments/statistics/welch.h"
#include "tests/experiments/scenes/generated.h"
#include "tests/support/known_answers.h"

using namespace ulam;

namespace {

Scene sceneOf(const Json& generator, int size = 16) {
    return describeGenerator(generator).build({{"width", size}, {"height", size}});
}

Budget samples(double spp) {
    Budget budget;
    budget.spp = spp;
    return budget;
}

std::vector<double> energies(const std::vector<RenderResult>& runs) {
    std::vector<double> result;
    for (const RenderResult& run : runs) {
        CHECK(run.statistics.nonFinite.counts().empty());
        CHECK(run.statistics.biasLedger.empty());
        result.push_back(tileMeans(run.image, 1)[0]);
    }
    return result;
}

/// Path tracing against bidirectional path tracing: different techniques with the same expectation. `largestError` is
/// twice the relative standard error of the difference that these seeds give.
void checkEnergies(const Json& generator, int depth, double pathSpp, double bdptSpp, double largestError) {
    constexpr int kRuns = 20;
    const Scene scene = sceneOf(generator);
    const auto path =
        energies(renderRuns(scene, {{"type", "path"}, {"max_depth", depth}}, samples(pathSpp), kRuns, 101));
    const auto bdpt =
        energies(renderRuns(scene, {{"type", "bdpt"}, {"max_depth", depth}}, samples(bdptSpp), kRuns, 102));
    const auto p = statistics::estimateMean(path), b = statistics::estimateMean(bdpt);
    const auto test = statistics::welchTest(p, b);
    const double error = std::sqrt(p.varianceOfMean + b.varianceOfMean) / b.mean;
    INFO(generator.dump() << ": path " << p.mean << ", bdpt " << b.mean << ", t " << test.t << ", relative error "
                          << error);
    CHECK(test.p > 1e-5);
    // So that the test says something: it sees differences of five of these.
    CHECK(error < largestError);
}

}  // namespace

TEST_CASE("hard scenes: path tracing and bidirectional path tracing agree in energy") {
    SECTION("necklace") {
        checkEnergies({{"type", "necklace"}, {"alpha", 0.2}}, 5, 64, 64, 0.004);
    }
    SECTION("keyhole") {
        checkEnergies({{"type", "keyhole"}, {"hole_size", 2}, {"holes", 2}}, 5, 256, 128, 0.016);
    }
    SECTION("egg_room") {
        checkEnergies({{"type", "egg_room"}, {"alpha", 0.3}}, 4, 256, 64, 0.01);
    }
    SECTION("mis_plates") {
        checkEnergies({{"type", "mis_plates"}}, 3, 128, 128, 0.02);
    }
}

TEST_CASE("hard scenes: every contribution is finite, and the images are neither black nor dazzling") {
    for (const char* name : {"door_ajar", "mis_plates", "keyhole", "torus_in_glass", "ring", "pool", "egg_room",
                             "mirror_caustic_room", "cornell_box", "necklace"}) {
        Json generator = {{"type", name}};
        if (generator["type"] == "cornell_box") generator["variant"] = "glossy";
        const RenderResult run =
            renderRuns(sceneOf(generator), {{"type", "bdpt"}, {"max_depth", 6}}, samples(64), 1, 103)[0];
        CHECK(run.statistics.nonFinite.counts().empty());
        const double mean = tileMeans(run.image, 1)[0];
        INFO(name << ": " << mean);
        CHECK(mean > 0.05);
        CHECK(mean < 1);
        for (const Rgb& pixel : run.image.pixels)
            for (int k = 0; k < 3; ++k) REQUIRE((std::isfinite(pixel[k]) && pixel[k] >= 0));
    }
}

TEST_CASE("ring: chains with lens perturbations through several specular chains refuse nothing") {
    const Json sampler = {{"type", "mlt"},
                          {"max_depth", 6},
                          {"mutations",
                           {{"bidirectional", {{"weight", 0.5}}},
                            {"lens", Json::object()},
                            {"caustic", Json::object()},
                            {"multi_chain", Json::object()}}}};
    Budget budget;
    budget.mutations = 1e6;
    const RenderResult run = renderRuns(sceneOf({{"type", "ring"}, {"alpha", 0}}, 64), sampler, budget, 1, 104)[0];
    CHECK(run.statistics.nonFinite.counts().empty());
    CHECK(run.statistics.mutations >= 1'000'000);
    for (const auto& [name, statistics] : run.statistics.mutationStatistics) {
        INFO(name);
        CHECK(statistics.accepted > 0);
    }
}
