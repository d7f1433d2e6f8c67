#include "experiments/engine/sweep.h"

#include <numeric>
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

TEST_CASE("a linear range has equal differences and exact ends", "[sweep]") {
    const auto real = expand({{"budget.time", {{"linear", {0.1, 0.7}}, {"steps", 4}}}});
    REQUIRE(real.size() == 4);
    CHECK(real[0][0].value == 0.1);
    CHECK(real[1][0].value.get<double>() == Approx(0.3).epsilon(1e-12));
    CHECK(real[3][0].value == 0.7);
    const auto down = expand({{"max_depth", {{"linear", {8, 2}}, {"steps", 3}}}});
    REQUIRE(down.size() == 3);
    CHECK(down[1][0].value == 5);
    CHECK(down[1][0].value.is_number_integer());
    // Steps that round to the same number are one.
    CHECK(expand({{"max_depth", {{"linear", {1, 3}}, {"steps", 9}}}}).size() == 3);
}

TEST_CASE("random draws are uniform on their scale and belong to the seed and the key", "[sweep]") {
    const auto values = [](const char* key, const Json& range, uint64_t seed = 1) {
        Json experiment = tinyExperiment();
        experiment["seed"] = seed;
        std::vector<double> all;
        for (const SweepPoint& point : expandSweep(JsonNode(Json{{key, range}}), JsonNode(experiment))) all.push_back(point[0].value.get<double>());
        return all;
    };
    constexpr int kDraws = 1000;
    const auto linear = values("budget.time", {{"linear", {2.5, 4.5}}, {"draws", kDraws}});
    REQUIRE(linear.size() == kDraws);
    CHECK(std::ranges::min(linear) >= 2.5);
    CHECK(std::ranges::max(linear) <= 4.5);
    const auto mean = [](const std::vector<double>& x) { return std::accumulate(x.begin(), x.end(), 0.0) / double(x.size()); };
    // Four standard errors of a uniform number's mean: false alarms of a fixed seed would stay for ever, once in 15 000.
    CHECK(mean(linear) == Approx(3.5).margin(4 * 2 / std::sqrt(12.0 * kDraws)));
    auto logarithmic = values("budget.time", {{"log", {0.01, 100.5}}, {"draws", kDraws}});
    for (double& x : logarithmic) x = std::log(x / 0.01) / std::log(100.5 / 0.01);
    CHECK(mean(logarithmic) == Approx(0.5).margin(4 / std::sqrt(12.0 * kDraws)));

    const Json five = {{"log", {0.5, 8}}, {"draws", 5}}, three = {{"log", {0.5, 8}}, {"draws", 3}};
    const auto first = values("budget.time", five), fewer = values("budget.time", three);
    CHECK(first == values("budget.time", five));
    CHECK(std::equal(fewer.begin(), fewer.end(), first.begin()));
    CHECK(first != values("budget.spp", five));
    CHECK(first != values("budget.time", five, 2));

    // Whole numbers: both ends come, a grid has each once, a zip has as many as were asked for.
    std::vector<double> dice = values("max_depth", {{"linear", {6, 1}}, {"draws", 200}});
    std::ranges::sort(dice);
    CHECK(dice == std::vector<double>{1, 2, 3, 4, 5, 6});
    CHECK(expand({{"zip", {{"max_depth", {{"linear", {1, 6}}, {"draws", 20}}}, {"budget.time", {{"log", {1.5, 2.5}}, {"draws", 20}}}}}}).size() == 20);
}

TEST_CASE("conditions leave points out", "[sweep]") {
    const auto count = [](const Json& where) {
        return expand({{"max_depth", {2, 3, 4}}, {"budget.spp", {2, 3, 4}}, {"where", where}}).size();
    };
    const auto one = [](const char* path, const char* comparison, const Json& value) { return Json::array({Json::array({path, comparison, value})}); };
    CHECK(count(one("max_depth", "<", 4)) == 6);
    CHECK(count(one("max_depth", "<=", 4)) == 9);
    CHECK(count(one("max_depth", ">", 3)) == 3);
    CHECK(count(one("max_depth", ">=", 3.5)) == 3);
    CHECK(count(one("max_depth", "==", 3.0)) == 3);
    CHECK(count(one("max_depth", "!=", 3)) == 6);
    CHECK(count(one("max_depth", "in", {2, 4, 17})) == 6);
    CHECK(count(one("max_depth", ">", {{"path", "budget.spp"}})) == 3);
    CHECK(count(Json::array({Json::array({"max_depth", ">", 2}), Json::array({"budget.spp", "==", {{"path", "max_depth"}}})})) == 2);
    CHECK(count(one("samplers.path.type", "==", "path")) == 9);
    CHECK(count(one("samplers.path.type", "in", {"bdpt", "path"})) == 9);
    CHECK(count(Json::array()) == 9);

    const auto message = [&](const Json& where) { return errorOf([&] { count(where); }).message; };
    CHECK(mentions(message(one("max_depth", ">", 9)), "no point of the sweep"));
    CHECK(mentions(message(one("max_dept", ">", 1)), "no value at \"max_dept\""));
    CHECK(mentions(message(one("samplers.path", "==", "path")), "no single value"));
    CHECK(mentions(message(one("max_depth", "=>", 1)), "comparison"));
    CHECK(mentions(message(one("max_depth", ">", "much")), "cannot compare"));
    CHECK(mentions(message(one("samplers.path.type", "<", "path")), "cannot compare"));
    CHECK(mentions(message(one("max_depth", "in", 3)), "a list of values"));
    CHECK(mentions(message(one("max_depth", "==", {3})), "expected a number"));
    CHECK(mentions(message(one("max_depth", "==", {{"pth", "x"}})), "pth"));
    CHECK(mentions(message("max_depth > 3"), "array"));
    CHECK(mentions(message(Json::array({"max_depth", ">", 3})), "a condition"));
}

TEST_CASE("zipped keys go together", "[sweep]") {
    const auto points = expand({{"zip", {{"max_depth", {2, 3}}, {"budget.spp", {8, 16}}}}});
    REQUIRE(points.size() == 2);
    CHECK(points[1].size() == 2);
    CHECK(points[1][1].value == 16);
    CHECK(mentions(errorOf([] {
                       expand({{"zip", {{"max_depth", {2, 3}}, {"budget.spp", {8}}}}});
                   }).message,
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
    CHECK(twins[0][0].shortLabel == "path.rr_depth=3");
    // A column of a zip may repeat a value, which keeps its label.
    const auto zipped = expand({{"zip", {{"max_depth", {2, 2, 3}}, {"budget.spp", {8, 16, 16}}}}});
    CHECK(zipped[0][0].label == "max_depth=2");
    CHECK(zipped[1][0].label == "max_depth=2");
}

TEST_CASE("short names are the last steps that tell a path from others", "[sweep]") {
    const std::vector<std::string> paths{"samplers.a.mutations.lens.weight", "samplers.b.mutations.lens.weight", "samplers.a.chains", "weight"};
    CHECK(shortName(paths[0], paths) == "a.mutations.lens.weight");
    CHECK(shortName(paths[2], paths) == "chains");
    CHECK(shortName(paths[3], paths) == "weight");  // all of it, though others end so
}

TEST_CASE("keys of the whole run cannot be swept", "[sweep]") {
    for (const char* key : {"name", "$schema", "metrics", "metrics.0", "baseline", "seed"}) {
        for (const Json& sweep : {Json{{key, {"a", "b"}}}, Json{{"zip", {{key, {"a", "b"}}}}}}) {
            const auto [code, message] = errorOf([&] { expand(sweep); });
            CHECK(code == ExitCode::InvalidConfig);
            CHECK(mentions(message, fmt::format("\"{}\"", key)));
            CHECK(mentions(message, "whole run"));
        }
    }
    CHECK(mentions(errorOf([] { expand({{"zip", {{"sweep.max_depth", {1, 2}}}}}); }).message, "itself"));
    CHECK(expand({{"replicates", {2, 3}}, {"reference.budget.spp", {64, 128}}}).size() == 4);
}

TEST_CASE("keys that overwrite each other, and equal points, are refused", "[sweep]") {
    const auto message = [](const Json& sweep) { return errorOf([&] { expand(sweep); }).message; };
    CHECK(mentions(message({{"max_depth", {2, 3}}, {"zip", {{"max_depth", {4, 5}}, {"budget.spp", {8, 16}}}}}),
                   "\"max_depth\" twice"));
    const Json depth = {4, 5}, whole = {{{"type", "path"}}, {{"type", "bdpt"}}};
    CHECK(mentions(message({{"samplers.path.rr_depth", depth}, {"samplers.path", whole}}), "replaces"));
    CHECK(expand({{"samplers.path", whole}, {"samplers.path.rr_depth", depth}}).size() == 4);

    CHECK(mentions(message({{"max_depth", {2, 3, 2.0}}}), "max_depth = 2.0 twice"));
    CHECK(mentions(message({{"zip", {{"max_depth", {2, 2}}, {"budget.spp", {8, 8.0}}}}}), "twice"));
    CHECK(mentions(message({{"film", {{{"width", 8}, {"height", 4}}, {{"height", 4}, {"width", 8}}}}}), "twice"));
}

TEST_CASE("a grid of too many points is refused before it is made", "[sweep]") {
    Json sweep = Json::object();
    // 1000^8 points: more than a word counts.
    for (const char* key : {"a", "b", "c", "d", "e", "f", "g", "h"})
        sweep[key] = {{"log", {1.5, 1000}}, {"steps", 1000}};
    CHECK(mentions(errorOf([&] { expand(sweep); }).message, "more than 100000 points"));
}

TEST_CASE("what is no sweep is refused", "[sweep]") {
    CHECK(mentions(errorOf([] { expand({{"samplers.pth.rr_depth", {3}}}); }).message, "\"path\""));
    CHECK(errorOf([] { expand({{"max_depth", Json::array()}}); }).code == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"max_depth", {{"log", {0, 8}}, {"steps", 3}}}}); }).code == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"max_depth", {{"log", {1, 8}}, {"steps", 1}}}}); }).code == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"max_depth", {{"log", {1, 8}}, {"step", 3}}}}); }).code == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"max_depth", {{"log", {1, 8}}, {"steps", 3}, {"draws", 3}}}}); }).code == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"max_depth", {{"log", {1, 8}}, {"linear", {1, 8}}, {"steps", 3}}}}); }).code == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"max_depth", {{"linear", {1, 8}}, {"draws", 1001}}}}); }).code == ExitCode::InvalidConfig);
    CHECK(errorOf([] { expand({{"sweep.seed", {1, 2}}}); }).code == ExitCode::InvalidConfig);
}

TEST_CASE("keys of other scenes and samplers do not touch a cell", "[sweep]") {
    const SweepValue sampler{"samplers.mlt.chains", 1, "", ""}, scene{"scenes.hidden.holes", 1, "", ""},
        all{"max_depth", 1, "", ""};
    CHECK(affects(sampler, "hidden", "mlt"));
    CHECK_FALSE(affects(sampler, "hidden", "bdpt"));
    CHECK(affects(scene, "hidden", "bdpt"));
    CHECK_FALSE(affects(scene, "open", "bdpt"));
    CHECK(affects(all, "open", "bdpt"));
}
