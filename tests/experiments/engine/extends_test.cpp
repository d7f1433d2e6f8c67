#include "experiments/engine/extends.h"

#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;

namespace {

JsonDocument readAll(const Folder& folder, const std::vector<std::pair<std::string, std::string>>& files) {
    for (const auto& [name, text] : files) writeFileAtomically(folder / name, text);
    return readExperiment(folder / files.front().first);
}

std::string errorOfReading(const std::vector<std::pair<std::string, std::string>>& files) {
    const Folder folder;
    return errorOf([&] { readAll(folder, files); }).message;
}

}  // namespace

TEST_CASE("an experiment without extends is its file", "[extends]") {
    const Folder folder;
    CHECK(readAll(folder, {{"a.json", R"({"name": "a"})"}}).json() == Json{{"name", "a"}});
}

TEST_CASE("what an experiment extends is merged member by member, the later file counts", "[extends]") {
    const Folder folder;
    const JsonDocument document = readAll(folder, {{"a.json", R"({"extends": ["b.json", "c.json"], "budget": {"time": 3}, "metrics": ["mse"],
                                                          "samplers": {"s": {"type": "path"}, "t": {"chains": 9}}})"},
                                                  {"b.json", R"({"extends": "d.json", "name": "b", "seed": 2, "budget": {"spp": 1}, "metrics": ["relmse", "flip"]})"},
                                                  {"c.json", R"({"seed": 3, "samplers": {"s": {"type": "mlt", "chains": 5}, "t": {"type": "mlt", "bootstrap": 7}}})"},
                                                  {"d.json", R"({"name": "d", "replicates": 8})"}});
    CHECK(document.json() == Json::parse(R"({"name": "b", "replicates": 8, "seed": 3, "budget": {"spp": 1, "time": 3}, "metrics": ["mse"],
                                             "samplers": {"s": {"type": "path"}, "t": {"type": "mlt", "bootstrap": 7, "chains": 9}}})"));
}

TEST_CASE("messages name the file a value comes from", "[extends]") {
    const Folder folder;
    JsonDocument document = readAll(folder, {{"a.json", "{\"extends\": \"b.json\",\n \"budget\": {\"time\": 1}}"},
                                             {"b.json", "{\"name\": \"b\",\n\"budget\": {\n\"spp\": 2}, \"film\": {\"width\": 3}}"}});
    CHECK(mentions(document.root().at("budget").at("time").where(), "a.json:2:"));
    CHECK(mentions(document.root().at("budget").at("spp").where(), "b.json:3:"));
    CHECK(mentions(document.root().at("film").where(), "b.json:3:"));
    document.set("budget.spp", 4, "--set budget.spp=4");
    CHECK(mentions(document.root().at("budget").at("spp").where(), "--set budget.spp=4"));
    CHECK(mentions(document.root().at("film").at("width").where(), "b.json:3:"));
}

TEST_CASE("files that cannot be extended are refused", "[extends]") {
    CHECK(mentions(errorOfReading({{"a.json", R"({"extends": "b.json"})"}, {"b.json", R"({"extends": "a.json"})"}}), "\"a.json\" would extend itself"));
    CHECK(mentions(errorOfReading({{"a.json", R"({"extends": "a.json"})"}}), "itself"));
    CHECK(mentions(errorOfReading({{"a.json", R"({"extends": "../b.json"})"}}), "in the folder of this one"));
    CHECK(mentions(errorOfReading({{"a.json", R"({"extends": "b.json"})"}}), "b.json"));
    CHECK(mentions(errorOfReading({{"a.json", R"({"extends": 3})"}}), "a.json:1:13"));
    CHECK(mentions(errorOfReading({{"a.json", R"({"extends": "b.json"})"}, {"b.json", "[]"}}), "b.json"));
}

TEST_CASE("an extended experiment is planned as one that is written out", "[extends]") {
    const Folder folder;
    Json base = tinyExperiment(), own = {{"extends", "base.json"}, {"samplers", {{"path", {{"rr_depth", 4}}}}}};
    Json whole = base;
    whole["samplers"]["path"]["rr_depth"] = 4;
    writeFileAtomically(folder / "base.json", base.dump(2));
    writeFileAtomically(folder / "own.json", own.dump(2));
    const Plan plan = makePlan(readExperiment(folder / "own.json"), folder / "own.json"), expected = planOf(folder, whole);
    REQUIRE(plan.cells.size() == expected.cells.size());
    for (size_t i = 0; i < plan.cells.size(); ++i) CHECK(plan.cells[i].task.hash() == expected.cells[i].task.hash());
    // Nothing is merged into what --set brings.
    JsonDocument late = readExperiment(folder / "base.json");
    late.set("extends", "own.json", "--set extends=own.json");
    CHECK(mentions(errorOf([&] { makePlan(late, folder / "base.json"); }).message, "in a file only"));
}
