#include "experiments/engine/experiment.h"

#include <limits>

#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;

namespace {

/// The message of planning the tiny experiment with one value changed, which must be an invalid configuration.
std::string refusal(const std::string& path, Json value) {
    const Folder folder;
    Json experiment = tinyExperiment();
    setValueByPath(experiment, path, std::move(value));
    const auto [code, message] = errorOf([&] { planOf(folder, experiment); });
    CHECK(code == ExitCode::InvalidConfig);
    INFO(path << ": " << message);
    CHECK(mentions(message, "/" + path.substr(0, path.find('.'))));  // the place
    return message;
}

}  // namespace

TEST_CASE("the tiny experiment is one", "[experiment]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    CHECK(plan.cells.size() == 2);
    CHECK(plan.name == "tiny");
}

TEST_CASE("misspelt keys name the nearest one", "[experiment]") {
    CHECK(mentions(refusal("replicats", 4), "replicates"));
    CHECK(mentions(refusal("budget.tme", 4), "time"));
    CHECK(mentions(refusal("samplers.path.rr_deph", 4), "rr_depth"));
    CHECK(mentions(refusal("samplers.path.type", "bdtp"), "bdpt"));
    CHECK(mentions(refusal("baseline", "pth"), "path"));
    CHECK(mentions(refusal("metrics", {"relmsee"}), "relmse"));
    CHECK(mentions(refusal("film.widht", 8), "did you mean \"width\"?"));
    CHECK(mentions(refusal("film.type", "hdrfil"), "hdrfilm"));
    CHECK(mentions(refusal("film.pixel_format", "rgb"), "film option"));
    CHECK(mentions(refusal("reference.prt", 4), "part"));
    CHECK(mentions(refusal("reference.part", {{"sp", 16}}), "spp"));
    CHECK(mentions(refusal("reference.sampler", "bdtp"), "bdpt"));
    CHECK(mentions(refusal("scenes.wall.wall.type", "rectangl"), "rectangle"));
}

TEST_CASE("values of the wrong type or out of range say what was expected", "[experiment]") {
    refusal("replicates", "many");
    refusal("replicates", 0);
    refusal("replicates", 2.5);
    refusal("seed", -1);
    refusal("max_depth", 0);
    refusal("samplers", Json::array());
    refusal("samplers", Json::object());
    refusal("scenes", Json::object());
    refusal("scenes", 7);
    refusal("film", 7);
    refusal("budget", Json::object());
    refusal("budget", {{"spp", 0}});
    refusal("budget", {{"time", -1}});
    refusal("metrics", Json::array());
    refusal("metrics", {"relmse", "relmse"});
    refusal("reference", 3);
    refusal("reference", "reference.png");
    refusal("reference.part", {{"spp", 0}});
    refusal("sweep", {{"samplers.path.rr_depth", 3}});
}

TEST_CASE("what does not fit together is refused", "[experiment]") {
    CHECK(mentions(refusal("budget.mutations", 1000), "no chains"));
    CHECK(mentions(refusal("samplers.path.max_depth", 4), "beside \"film\""));
    CHECK(mentions(refusal("metrics", {"psnr"}), "primary"));
    CHECK(mentions(refusal("reference", "truth"), "no closed form"));
    CHECK(mentions(refusal("reference.part", {{"time", 1}}), "other limits than its budget"));
    CHECK(mentions(refusal("reference.part", {{"spp", 32}, {"rays", 1000}}), "other limits than its budget"));
    CHECK(mentions(refusal("reference.part.spp", 0.02), "12800 parts"));
    CHECK(mentions(refusal("until", {{"max_replicates", 2}}), "at least the 3"));
    CHECK(mentions(refusal("until", {{"relative_ci", 0}}), "relative_ci"));
    CHECK(mentions(refusal("sweep", {{"until", {nullptr}}}), "whole run"));

    const Folder folder;
    Json both = tinyExperiment();
    both["scene"] = tinyScene();
    CHECK(mentions(errorOf([&] { planOf(folder, both); }).message, "either"));
    for (const char* key : {"samplers", "budget", "reference", "scenes"}) {
        Json without = tinyExperiment();
        without.erase(key);
        const auto [code, message] = errorOf([&] { planOf(folder, without); });
        CHECK(code == ExitCode::InvalidConfig);
        CHECK(mentions(message, key));
    }
}

TEST_CASE("files that are not there are missing inputs", "[experiment]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["scenes"]["wall"] = "no-such-scene.json";
    CHECK(errorOf([&] { planOf(folder, experiment); }).code == ExitCode::InputMissing);
    experiment = tinyExperiment();
    experiment["reference"] = "no-such-image.exr";
    CHECK(errorOf([&] { planOf(folder, experiment); }).code == ExitCode::InputMissing);
}

TEST_CASE("NaN is no value", "[experiment]") {
    const Folder folder;
    writeFileAtomically(folder / "nan.json", R"({"budget": {"time": NaN}})");
    const auto [code, message] = errorOf([&] { JsonDocument::fromFile(folder / "nan.json"); });
    CHECK(code == ExitCode::InvalidConfig);
    CHECK(mentions(message, "nan.json:1:21"));
}

TEST_CASE("the depth reaches every sampler and the reference", "[experiment]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    for (const Cell& cell : plan.cells) CHECK(cell.task.parameters["max_depth"] == 3);
    CHECK(plan.references[0].spec.parameters["max_depth"] == 3);
}

TEST_CASE("a mix of mutations is resolved to the last parameter", "[experiment]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["samplers"]["mlt"] = {{"type", "mlt"},
                                     {"mutations", {{"lens", Json::object()}, {"bidirectional", {{"weight", 0.5}}}}}};
    const Json mutations = planOf(folder, experiment).cells.back().task.parameters["mutations"];
    CHECK(mutations["lens"]["weight"] == 1);
    CHECK(mutations["lens"].size() > 2);
    CHECK(mutations["bidirectional"]["weight"] == 0.5);
    setValueByPath(experiment, "samplers.mlt.mutations.lense", Json::object());
    CHECK(mentions(errorOf([&] { planOf(folder, experiment); }).message, "did you mean \"lens\""));
}

TEST_CASE("a reference may differ from scene to scene", "[experiment]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["scenes"]["other"] = tinyScene();
    experiment["scenes"]["other"]["lamp"]["emitter"]["radiance"] = 1;
    const Json made = experiment["reference"];
    experiment["reference"] = {{"wall", made}, {"other", made}};
    experiment["reference"]["other"]["part"]["spp"] = 64;
    const Plan plan = planOf(folder, experiment);
    REQUIRE(plan.references.size() == 2);
    CHECK(plan.references[0].task.replicates == 8);
    CHECK(plan.references[1].task.replicates == 4);
    CHECK(plan.cells[0].reference != plan.cells.back().reference);

    experiment["reference"].erase("other");
    CHECK(mentions(errorOf([&] { planOf(folder, experiment); }).message, "other"));
}

TEST_CASE("the schema describes exactly the keys that are read", "[experiment]") {
    const Json schema = experimentSchema();
    CHECK(schema["$schema"] == "http://json-schema.org/draft-07/schema#");
    std::vector<std::string> keys;
    for (const ParameterInfo& info : parameterInfo<ExperimentParameters>()) keys.push_back(info.name);
    CHECK(schema["properties"].size() == keys.size());
    for (const std::string& key : keys) {
        CHECK(schema["properties"].contains(key));
        CHECK(schema["properties"][key].contains("description"));
    }
    CHECK(schema["additionalProperties"] == false);
    CHECK(schema["definitions"]["budget"]["properties"].contains("rays"));
    bool path = false;
    for (const Json& sampler : schema["definitions"]["sampler"]["anyOf"])
        path |= sampler["properties"]["type"]["const"] == "path";
    CHECK(path);
}
