// The reference that the ready-made experiment ships was made by drawing directions through the known holes. Here
// bidirectional path tracing, which knows nothing of holes, is held against it.

#include <filesystem>

#include "core/image/image_io.h"
#include "core/render/driver.h"
#include "core/scene/load.h"
#include "experiments/statistics/holm.h"
#include "experiments/statistics/welch.h"
#include "tests/support/catch.h"

using namespace ulam;

TEST_CASE("the shipped reference of the hidden grid of holes agrees with bidirectional path tracing", "[reference]") {
    const std::filesystem::path folder = "experiments/references";
    const Image reference = readImage((folder / "backlit_grid_hidden.exr").string());
    const Image variance = readImage((folder / "backlit_grid_hidden.variance.exr").string());
    REQUIRE(reference.width == 256);
    REQUIRE(reference.height == 256);

    const JsonDocument scene = JsonDocument::fromText(R"({"type": "grid_of_holes", "back": "hidden"})", "scene");
    const Scene built = SceneDescription::fromNode(scene.root(), ".").build(Json{{"width", 256}, {"height", 256}});
    const auto sampler = Registry<Sampler>::instance().create(JsonNode(Json{{"type", "bdpt"}, {"max_depth", 8}}));

    // Tiles of 64 × 64 pixels: in smaller ones the rare bright samples of the judge are too few for a t-test.
    constexpr int kTiles = 4, kEdge = 256 / kTiles, kReplicates = 12;
    const auto tileMeans = [](const Image& image) {
        std::vector<double> means(kTiles * kTiles);
        for (int y = 0; y < 256; ++y)
            for (int x = 0; x < 256; ++x) means[size_t(y / kEdge * kTiles + x / kEdge)] += luminance(Spectrum(image.at(x, y))) / (kEdge * kEdge);
        return means;
    };
    std::vector<std::vector<double>> tiles(kTiles * kTiles);
    std::vector<double> totals;
    for (int r = 0; r < kReplicates; ++r) {
        RenderOptions options;
        options.budget.spp = 8;
        options.threads = 2;
        options.key = makeKey(2026, 0, uint64_t(r));
        const auto means = tileMeans(render(built, *sampler, options).image);
        double total = 0;
        for (size_t i = 0; i < means.size(); ++i) {
            tiles[i].push_back(means[i]);
            total += means[i] / double(means.size());
        }
        totals.push_back(total);
    }
    const auto truth = tileMeans(reference), truthVariance = tileMeans(variance);
    std::vector<double> p;
    double total = 0, totalVariance = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        const double pixels = kEdge * kEdge, varianceOfMean = truthVariance[i] / pixels;
        total += truth[i] / double(truth.size());
        totalVariance += varianceOfMean / double(truth.size() * truth.size());
        p.push_back(statistics::welchTest(statistics::estimateMean(tiles[i]), {truth[i], varianceOfMean, 15}).p);
    }
    const auto adjusted = statistics::holmAdjusted(p);
    CHECK(*std::min_element(adjusted.begin(), adjusted.end()) > 1e-3);

    const auto estimate = statistics::estimateMean(totals);
    INFO("total " << estimate.mean << " against " << total << ", standard error " << std::sqrt(estimate.varianceOfMean));
    CHECK(statistics::welchTest(estimate, {total, totalVariance, 15}).p > 1e-3);
    // The comparison must be sharp enough to mean something.
    CHECK(std::sqrt(estimate.varianceOfMean) < 0.02 * total);
}
