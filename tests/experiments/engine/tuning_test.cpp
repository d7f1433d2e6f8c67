#include "experiments/engine/tuning.h"

#include <set>

#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;

namespace {

/// Chains that hardly move against chains that do: the step of the only mutation is tuned.
Json tunedExperiment() {
    Json experiment = tinyExperiment();
    experiment["samplers"] = {
        {"mlt", {{"type", "pssmlt"}, {"chains", 8}, {"mutations", {{"kelemen_step", Json::object()}, {"large_step", {{"weight", 1}}}}}}}};
    experiment["baseline"] = "mlt_untuned";
    experiment["budget"] = {{"spp", 36}};
    experiment["snapshots"] = 0;
    experiment["common_random_numbers"] = true;
    // Nearly no large steps are far worse than many.
    experiment["tune"] = {{"sweep", {{"samplers.mlt.mutations.large_step.weight", {1e-6, 1e-5, 1e-4, 0.3, 1e-3}}}}, {"reduction", 2}, {"replicates", 3}};
    return experiment;
}

JsonDocument documentOf(const Json& experiment) {
    return JsonDocument::fromText(experiment.dump(), "experiment.json");
}

std::string tuningRefusal(const std::string& path, const Json& value) {
    JsonDocument document = documentOf(tunedExperiment());
    document.set(path, value, "test");
    return errorOf([&] { plannedTuning(document); }).message;
}

}  // namespace

TEST_CASE("rounds halve the candidates and double the budget", "[tuning]") {
    JsonDocument document = documentOf(tunedExperiment());
    const Tuning tuning = *plannedTuning(document);
    CHECK(tuning.sampler == "mlt");
    const auto rounds = tuningRounds(tuning);
    REQUIRE(rounds.size() == 3);
    CHECK(rounds[0].candidates == 5);
    CHECK(rounds[1].candidates == 3);
    CHECK(rounds[2].candidates == 2);
    CHECK(rounds[0].fraction == Approx(0.25));
    CHECK(rounds[2].fraction == 1);
    CHECK(document.json()["samplers"]["mlt_untuned"] == tunedExperiment()["samplers"]["mlt"]);
    JsonDocument plain = documentOf(tinyExperiment());
    CHECK_FALSE(plannedTuning(plain));
}

TEST_CASE("the winner is judged by runs that did not choose it", "[tuning]") {
    const Folder folder;
    JsonDocument document = documentOf(tunedExperiment());
    const Tuning tuning = *plannedTuning(document);
    std::filesystem::create_directories(folder / "run/tuning");
    static const std::atomic<bool> never = false;
    Progress progress(true);
    const RunOptions options{folder / "run", 1, false};
    const TuningOutcome outcome = tune(document, folder / "experiment.json", tuning, options, never, progress);
    CHECK_FALSE(outcome.interrupted);
    CHECK(outcome.record["winner"] == Json{{"samplers.mlt.mutations.large_step.weight", 0.3}});
    CHECK(outcome.record["rounds"].size() == 3);
    CHECK(outcome.record["candidates"][3]["scores"].size() == 3);

    std::set<std::pair<uint32_t, uint32_t>> chose;
    for (std::size_t round = 0; round < 3; ++round) {
        const Plan plan = makePlan(roundExperiment(document, tuning, round, {0, 3}), folder / "experiment.json");
        CHECK(plan.cells.size() == 2);
        CHECK(plan.comparisons.empty());
        for (const Cell& cell : plan.cells)
            for (int r = 0; r < cell.task.replicates; ++r) chose.insert({cell.task.key(r).low, cell.task.key(r).high});
    }
    const Plan plan = makePlan(outcome.experiment, folder / "experiment.json");
    REQUIRE(plan.cells.size() == 2);
    CHECK(plan.cells[0].task.parameters["mutations"]["large_step"]["weight"] == 0.3);
    CHECK(plan.cells[1].task.parameters["mutations"]["large_step"]["weight"] == 1);
    for (const Cell& cell : plan.cells)
        for (int r = 0; r < cell.task.replicates; ++r)
            CHECK_FALSE(chose.contains({cell.task.key(r).low, cell.task.key(r).high}));

    // Gone on with, it renders nothing and finds the same.
    const auto stamp = std::filesystem::last_write_time(folder / "run/tuning/round1/cells/wall-c0/r000/result.json");
    CHECK(tune(document, folder / "experiment.json", tuning, options, never, progress).record == outcome.record);
    CHECK(std::filesystem::last_write_time(folder / "run/tuning/round1/cells/wall-c0/r000/result.json") == stamp);
}

TEST_CASE("what cannot be tuned is refused", "[tuning]") {
    CHECK(mentions(tuningRefusal("tune.sweep", {{"budget.spp", {1, 2}}}), "no parameter of a sampler"));
    CHECK(mentions(tuningRefusal("tune.sweep", {{"samplers.mlt.chains", {1}}}), "two candidates"));
    CHECK(mentions(tuningRefusal("tune.sweep", {{"samplers.mtl.chains", {1, 2}}}), "mlt"));
    const std::string misspelt = tuningRefusal("tune.sweep", {{"samplers.mlt.chians", {1, 2}}});
    CHECK(mentions(misspelt, "chains"));
    CHECK(mentions(misspelt, "tune.sweep samplers.mlt.chians=1"));
    CHECK(mentions(tuningRefusal("tune.sweep", {{"samplers.mlt.chains", {1, 0}}}), "tune.sweep samplers.mlt.chains=0"));
    CHECK(mentions(tuningRefusal("tune.reduction", 1), "reduction"));
    CHECK(mentions(tuningRefusal("samplers.mlt_untuned", {{"type", "path"}}), "before tuning"));
    JsonDocument two = documentOf(tunedExperiment());
    two.set("samplers.other", {{"type", "mlt"}}, "test");
    two.set("tune.sweep", {{"samplers.mlt.chains", {1, 2}}, {"samplers.other.chains", {1, 2}}}, "test");
    CHECK(mentions(errorOf([&] { plannedTuning(two); }).message, "one sampler"));
}

TEST_CASE("what is tuned is not swept as well", "[tuning]") {
    CHECK(mentions(tuningRefusal("sweep", {{"samplers.mlt.mutations.large_step.weight", {1, 2}}}), "swept and tuned"));
    CHECK(mentions(tuningRefusal("sweep", {{"samplers.mlt", Json::array({Json{{"type", "pssmlt"}}})}}), "swept and tuned"));
    JsonDocument other = documentOf(tunedExperiment());
    other.set("sweep", {{"samplers.mlt.chains", {8, 16}}}, "test");
    CHECK(plannedTuning(other));
}

TEST_CASE("a candidate that fails loses its round", "[tuning]") {
    const Folder folder;
    const auto outcomeOf = [&](const std::string& parameter, const Json& values) {
        Json experiment = tunedExperiment();
        experiment["samplers"]["mlt"] = {{"type", "portal"}};
        experiment["tune"]["sweep"] = {{"samplers.mlt." + parameter, values}};
        JsonDocument document = documentOf(experiment);
        const Tuning tuning = *plannedTuning(document);
        static const std::atomic<bool> never = false;
        Progress progress(true);
        return tune(document, folder / "experiment.json", tuning, {folder / parameter, 1, false}, never, progress);
    };
    // The sampler portal needs a scene with holes.
    const TuningOutcome outcome = outcomeOf("type", {"portal", "path"});
    CHECK(outcome.record["winner"] == Json{{"samplers.mlt.type", "path"}});
    CHECK(outcome.record["candidates"][0]["scores"] == Json::array({nullptr}));
    CHECK(mentions(errorOf([&] { outcomeOf("rr_depth", {5, 6}); }).message, "every candidate failed"));
}

TEST_CASE("a reference by a sampler of the experiment stays that sampler", "[tuning]") {
    Json experiment = tunedExperiment();
    experiment["samplers"]["mine"] = {{"type", "bdpt"}};
    experiment["reference"] = {{"wall", {{"sampler", "mine"}, {"budget", {{"spp", 64}}}}}};
    JsonDocument document = documentOf(experiment);
    const Tuning tuning = *plannedTuning(document);
    const Plan plan = makePlan(roundExperiment(document, tuning, 0, {0, 1}), "experiment.json");
    CHECK(plan.references[0].task.parameters["type"] == "bdpt");
}
