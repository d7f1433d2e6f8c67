#include "core/render/state_counts.h"

#include <numeric>

#include "core/render/driver.h"
#include "tests/support/catch.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

namespace {

double sumOf(const Image& image) {
    return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0, [](double sum, const Rgb& p) { return sum + p.x; });
}

}  // namespace

TEST_CASE("a step counts in the pixel of the state it leaves or stays in", "[state_counts]") {
    StateCounts counts(3, 2), others(3, 2);
    counts.add({0.9f, 1.2f}, true);
    counts.add({0.1f, 1.9f}, false);
    others.add({3.0f, -0.1f}, true);  // beyond the edge, as a wide filter allows
    counts.take(others);
    std::map<std::string, Image> images, nothing;
    counts.develop(images);
    others.develop(nothing);
    CHECK(images.at("proposed").at(0, 1).x == 2);
    CHECK(images.at("accepted").at(0, 1).x == 1);
    CHECK(images.at("accepted").at(2, 0).y == 1);
    CHECK(sumOf(images.at("proposed")) == 3);
    CHECK(sumOf(nothing.at("proposed")) == 0);
}

TEST_CASE("images of acceptance have every step of every chain", "[state_counts]") {
    const Scene scene = buildScene(pathScene("diffuse").dictionary);
    for (const char* type : {"mlt", "pssmlt"}) {
        const auto sampler = Registry<Sampler>::instance().create(
            JsonNode(Json{{"type", type}, {"max_depth", 4}, {"chains", 20}, {"bootstrap", 2000}, {"acceptance_images", true}}));
        RenderOptions options;
        options.budget.mutations = 20'000;
        options.key = makeKey(3);
        options.threads = 2;
        const RenderStatistics statistics = render(scene, *sampler, options).statistics;
        uint64_t proposed = 0, accepted = 0;
        for (const auto& [name, s] : statistics.mutationStatistics) proposed += s.proposed, accepted += s.accepted;
        CHECK(accepted > 1000);
        CHECK(sumOf(statistics.extraImages.at("proposed")) == double(proposed));
        CHECK(sumOf(statistics.extraImages.at("accepted")) == double(accepted));
    }
}
