// Scenes whose image is known × all registered samplers.

#include "tests/support/known_answers.h"

#include "tests/experiments/scenes/generated.h"

using namespace ulam;

namespace {

constexpr int kRuns = 12;

/// A scene with its known image, and how sure the mean of all runs must be.
struct Known {
    Json generator;
    int size, depth;
    double spp, mutationsPerPixel, bootstrap;
    int tiles;
    double largestError;  ///< relative standard error of the total, over all runs
};

void compare(const Known& known) {
    const SceneDescription description = describeGenerator(known.generator);
    const Json film = {{"width", known.size}, {"height", known.size}};
    const Scene scene = description.build(film);
    const auto truth = description.generator()->truth(description.filmSize(film));
    REQUIRE(truth);
    const std::vector<double> tiles = tileMeans(*truth, known.tiles), shares = description.generator()->featureShares();
    const double total = tileMeans(*truth, 1)[0];
    Verdict verdict;
    for (const std::string& name : samplerNames()) {
        if (name == "portal" && scene.features.empty()) continue;  // it samples openings
        Json sampler = {{"type", name}, {"max_depth", known.depth}};
        const bool chains = isChainSampler(name);
        if (chains) sampler["bootstrap"] = known.bootstrap, sampler["chains"] = 200;
        Budget budget;
        budget.spp = chains ? known.mutationsPerPixel : known.spp;
        const auto runs = renderRuns(scene, sampler, budget, kRuns, 71);
        const auto judge = [&](const std::string& what, double expected, auto&& value) {
            std::vector<double> values;
            for (const RenderResult& run : runs) values.push_back(value(run));
            const Deviation d = deviation(values, expected);
            verdict.add(d, expected, fmt::format("{} {}", name, what));
            return d;
        };
        const Deviation whole =
            judge("total", total, [](const RenderResult& run) { return tileMeans(run.image, 1)[0]; });
        INFO(name << " total " << whole.mean << " ± " << whole.standardError << ", known " << total);
        // Most walks of particle tracing end where the camera does not look.
        CHECK(whole.standardError < known.largestError * total * (name == "light" ? 5 : 1));
        for (size_t i = 0; known.tiles > 1 && i < tiles.size(); ++i)
            judge(fmt::format("tile {}", i), tiles[i],
                  [&](const RenderResult& run) { return tileMeans(run.image, known.tiles)[i]; });
        for (size_t i = 0; i < shares.size(); ++i)
            judge(fmt::format("energy through {}", scene.features.names[i]), shares[i] * total,
                  [&](const RenderResult& run) { return run.statistics.featureEnergy[i]; });
        for (const RenderResult& run : runs) {
            CHECK(run.statistics.nonFinite.counts().empty());
            CHECK(run.statistics.biasLedger.empty());
        }
    }
    verdict.check();
}

}  // namespace

TEST_CASE("furnace: radiance 1 everywhere, within 0.1 % in total", "[known]") {
    // A third of it, so that 0.1 % are three standard errors.
    compare({{{"type", "furnace"}, {"reflectance", 0.5}, {"max_depth", 3}}, 16, 3, 300, 700, 150'000, 4, 3.3e-4});
}

TEST_CASE("sphere with a light at its centre", "[known]") {
    compare(
        {{{"type", "sphere_light_center"}, {"reflectance", 0.5}, {"max_depth", 4}}, 16, 4, 200, 400, 50'000, 4, 1e-3});
}

TEST_CASE("parallel plates", "[known]") {
    compare({{{"type", "parallel_plates"}, {"distance", 0.6}}, 16, 4, 100, 400, 50'000, 4, 2e-3});
}

TEST_CASE("grid of holes in a sheet: the light through each hole is known", "[known]") {
    compare({{{"type", "grid_of_holes"}, {"holes", 2}, {"open_area", 0.1}, {"thickness", 0}, {"polygon_sides", 16}},
             16,
             3,
             200,
             800,
             100'000,
             4,
             0.01});
}

TEST_CASE("grid of holes in a thick plate: the light through each hole is known", "[known]") {
    compare({{{"type", "grid_of_holes"}, {"holes", 2}, {"open_area", 0.1}, {"thickness", 0.05}, {"polygon_sides", 16}},
             16,
             3,
             200,
             800,
             100'000,
             4,
             0.01});
}

TEST_CASE("the images of all techniques add up to the image", "[known]") {
    const Scene scene = describeGenerator({{"type", "cornell_box"}, {"variant", "glass_and_mirror"}})
                            .build({{"width", 16}, {"height", 16}});
    Budget budget;
    budget.spp = 64;
    const RenderResult run =
        renderRuns(scene, {{"type", "bdpt"}, {"max_depth", 5}, {"technique_images", true}}, budget, 1, 81)[0];
    CHECK(run.statistics.extraImages.size() > 20);
    std::vector<Spectrum> sums(run.image.pixels.size(), Spectrum(0.0));
    for (const auto& [name, image] : run.statistics.extraImages)
        for (size_t i = 0; name.ends_with("_weighted") && i < sums.size(); ++i) {
            const Rgb& p = image.pixels[i];
            sums[i] += Spectrum(p.x, p.y, p.z);
        }
    for (size_t i = 0; i < sums.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            // Each technique's image is rounded to float.
            REQUIRE(sums[i][c] == Approx(double(run.image.pixels[i][c])).epsilon(3e-7));
            REQUIRE(sums[i][c] >= 0);
        }
}
