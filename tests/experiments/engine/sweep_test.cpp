#include "experiments/engine/sweep.h"

#include <set>

#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;

namespace {

std::vector<SweepPoint> expand(const Json& sweep) {
    return expandSweep(JsonNode(sweep), JsonNode(tinyExperiment()));
}

}  // namespace

TEST_CASE("several keys make a grid, the last running fastest", "[sweep]") {
    const auto points = expand({{"max_depth", {2, 3}}, {"samplers.path.rr_depth", {4, 5, 6}}});
    REQUIRE(points.size() == 6);
    CHECK(points[1][0].value == 2);
    CHECK(points[1][1].value == 5);
    CHECK(points[5][1].label == "rr_depth=6");
}

TEST_CASE("no sweep is one empty point", "[sweep]") {
    const auto points = expandSweep(JsonNode(), JsonNode(tinyExperiment()));
    REQUIRE(points.size() == 1);
    CHECK(points[0].empty());
}

TEST_CASE("a logarithmic range has equal ratios and exact ends", "[sweep]") {
    const auto whole = expand({{"max_depth", {{"log", {100, 10000}}, {"steps", 3}}}});
    REQUIRE(whole.size() == 3);
    CHECK(whole[1][0].value == 1000);
    CHECK(whole[1][0].value.is_number_integer());
    const auto real = expand({{"budget.time", {{"log", {0.5, 8}}, {"steps", 5}}}});
    CHECK(real[2][0].value.get<double>() == Approx(2).epsilon(1e-12));
    CHECK(real[4][0].value == 8.0);

    // Whole numbers that no integer holds, and ends whose ratio is infinite.
    const auto large = expand({{"budget.spp", {{"log", {1, 1e30}}, {"steps", 4}}}});
    CHECK(large[1][0].value.get<double>() == Approx(1e10));
    CHECK(large[3][0].value == 1e30);
    const auto wide = expand({{"budget.time", {{"log", {1e-200, 1e200}}, {"steps", 3}}}});
    CHECK(wide[1][0].value.get<double>() == Approx(1));
}

TEST_CASE("zipped keys go together", "[sweep]") {
    const auto points = expand({{"zip", {{"max_depth", {2, 3}}, {"budget.spp", {8, 16}}}}});
    REQUIRE(points.size() == 2);
    CHECK(points[1].size() == 2);
    CHECK(points[1][1].value == 16);
    CHECK(contains(errorOf([] {
                       expand({{"zip", {{"max_depth", {2, 3}}, {"budget.spp", {8}}}}});
                   }).second,
                   "2 values"));
}

TEST_CASE("labels are fit for folders and differ", "[sweep]") {
    std::set<std::string> labels;
    for (const auto& point : expand({{"samplers.path", {{{"type", "path"}}, {{"type", "bdpt"}}}}}))
        labels.insert(point[0].label);
    CHECK(labels == std::set<std::string>{"path=no1", "path=no2"});
    CHECK(expand({{"film.rfilter.type", {"a/b"}}, {"budget.spp", {1}}})[0][0].label == "type=a_b");
    // Two keys with the same last step are told apart by the whole path.
    const auto twins = expand({{"samplers.path.rr_depth", {3}}, {"samplers.bdpt.rr_depth", {3}}});
    CHECK(twins[0][0].label == "samplers.path.rr_depth=3");
    // A column of a zip may repeat a value, which keeps its label.
    const auto zipped = expand({{"zip", {{"max_depth", {2, 2, 3}}, {"budget.spp", {8, 16, 16}}}}});
    CHECK(zipped[0][0].label == "max_depth=2");
    CHECK(zipped[1][0].label == "max_depth=2");
}

TEST_CASE("keys of the whole run cannot be swept", "[sweep]") {
    for (const char* key : {"name", "$schema", "metrics", "metrics.0", "baseline", "seed"}) {
        for (const Json& sweep : {Json{{key, {"a", "b"}}}, Json{{"zip", {{key, {"a", "b"}}}}}}) {
            const auto [code, message] = errorOf([&] { expand(sweep); });
            CHECK(code == ExitCode::InvalidConfig);
            CHECK(contains(message, fmt::format("\"{}\"", key)));
            CHECK(contains(message, "whole run"));
        }
    }
    CHECK(contains(errorOf([] { expand({{"zip", {{"sweep.max_depth", {1, 2}}}}}); }).second, "itself"));
    CHECK(expand({{"replicates", {2, 3}}, {"reference.budget.spp", {64, 128}}}).size() == 4);
}

TEST_CASE("keys that overwrite each other, and equal points, are refused", "[sweep]") {
    const auto message = [](const Json& sweep) { return errorOf([&] { expand(sweep); }).second; };
    CHECK(contains(message({{"max_depth", {2, 3}}, {"zip", {{"max_depth", {4, 5}}, {"budget.spp", {8, 16}}}}}),
                   "\"max_depth\" twice"));
    const Json depth = {4, 5}, whole = {{{"type", "path"}}, {{"type", "bdpt"}}};
    CHECK(contains(message({{"samplers.path.rr_depth", depth}, {"samplers.path", whole}}), "replaces"));
    CHECK(expand({{"samplers.path", whole}, {"samplers.path.rr_depth", depth}}).size() == 4);

    CHECK(contains(message({{"max_depth", {2, 3, 2.0}}}), "max_depth = 2.0 twice"));
    CHECK(contains(message({{"zip", {{"max_depth", {2, 2}}, {"budget.spp", {8, 8.0}}}}}), "twice"));
    CHECK(contains(message({{"film", {{{"width", 8}, {"height", 4}}, {{"height", 4}, {"width", 8}}}}}), "twice"));
}

TEST_CASE("a grid of too many points is refused before it is made", "[sweep]") {
    Json sweep = Json::object();
    // 1000^8 points: more than a word counts.
    for (const char* key : {"a", "b", "c", "d", "e", "f", "g", "h"})
        sweep[key] = {{"log", {1.5, 1000}}, {"steps", 1000}};
    CHECK(contains(errorOf([&] { expand(sweep); }).second, "more than 100000 points"));
}

TEST_CASE("what is no sweep is refused", "[sweep]") {
    CHECK(contains(errorOf([] { expand({{"samplers.pth.rr_depth", {3}}}); }).second, "\"path\""));
    CHECK(contains(errorOf([] { expand({{"where", "chains > 3"}}); }).second, "not supported"));
    CHECK(errorOf([] { expand({{"max_depth", Json::array()}}); }).first == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"max_depth", {{"log", {0, 8}}, {"steps", 3}}}}); }).first == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"max_depth", {{"log", {1, 8}}, {"steps", 1}}}}); }).first == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"max_depth", {{"log", {1, 8}}, {"step", 3}}}}); }).first == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"sweep.seed", {1, 2}}}); }).first == ExitCode::InvalidConfig);
}

TEST_CASE("keys of other scenes and samplers do not touch a cell", "[sweep]") {
    const SweepValue sampler{"samplers.mlt.chains", 1, ""}, scene{"scenes.hidden.holes", 1, ""},
        all{"max_depth", 1, ""};
    CHECK(affects(sampler, "hidden", "mlt"));
    CHECK_FALSE(affects(sampler, "hidden", "bdpt"));
    CHECK(affects(scene, "hidden", "bdpt"));
    CHECK_FALSE(affects(scene, "open", "bdpt"));
    CHECK(affects(all, "open", "bdpt"));
}
