// What is counted of values that are not finite, or too large to be added up.

#include "core/image/film.h"
#include "core/render/driver.h"
#include "tests/support/known_answers.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

TEST_CASE("the log keeps the first events in the order of the work, whoever met them") {
    NonFiniteLog one, other;
    for (uint64_t i = 0; i < 40; ++i) (i % 3 == 0 ? one : other).add({.unit = 100 - i, .cause = i % 2 == 0 ? "bsdf" : "light"});
    one.add({.kind = NonFiniteEvent::Kind::Pilot, .unit = 1000, .cause = "target"});
    one.take(other);
    CHECK(other.counts().empty());
    CHECK(one.counts() == std::map<std::string, uint64_t>{{"bsdf", 20}, {"light", 20}, {"target", 1}});
    REQUIRE(one.first().size() == NonFiniteLog::kKept);
    CHECK(one.first()[0].unit == 1000);
    for (size_t i = 1; i < NonFiniteLog::kKept; ++i) CHECK(one.first()[i].unit == 60 + i);
}

TEST_CASE("sums beyond what a film can hold are refused and counted") {
    // Parts of a sample are below the limit, some of their sums are not.
    const double radiance = 0.9 * FixedSum::kLargestTerm;
    const Json dictionary = {
        {"type", "scene"},
        {"sensor", {{"type", "perspective"}, {"fov", 60}, {"film", {{"type", "hdrfilm"}, {"width", 16}, {"height", 16}}},
                    {"to_world", Json::array({{{"type", "lookat"}, {"origin", {0, 0, 4}}, {"target", {0, 0, 0}}, {"up", {0, 1, 0}}}})}}},
        {"ball", {{"type", "sphere"}, {"radius", 1}, {"bsdf", {{"type", "diffuse"}, {"reflectance", 0.99}}}}},
        {"sky", {{"type", "constant"}, {"radiance", {radiance, 0, 0}}}}};
    const Scene scene = buildScene(dictionary);
    RenderOptions options;
    options.budget.spp = 16;
    options.key = makeKey(3);
    const auto sampler = Registry<Sampler>::instance().create(JsonNode(Json{{"type", "path"}}));
    const RenderResult result = render(scene, *sampler, options);
    CHECK(result.statistics.nonFinite.counts().contains("deposit"));
    for (const Rgb& p : result.image.pixels) CHECK(std::isfinite(p.x));
}
