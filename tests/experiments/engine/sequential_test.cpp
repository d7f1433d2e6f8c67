#include "experiments/engine/sequential.h"

#include <algorithm>
#include <map>

#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;

namespace {

/// A sampler with an equal, a worse one, and few replicates.
Json openQuestion(double relativeCi) {
    Json experiment = tinyExperiment();
    experiment["samplers"] = {{"path", {{"type", "path"}}}, {"again", {{"type", "path"}}}, {"other", {{"type", "light"}}}};
    experiment["reference"]["budget"]["spp"] = 1024;
    experiment["replicates"] = 5;
    experiment["snapshots"] = 0;
    experiment["until"] = {{"relative_ci", relativeCi}, {"max_replicates", 15}};
    return experiment;
}

std::map<std::string, int> replicatesOf(const Plan& plan) {
    std::map<std::string, int> replicates;
    for (const Cell& cell : plan.cells) replicates[cell.task.sampler] = cell.task.replicates;
    return replicates;
}

std::map<std::string, int> replicatesAfter(const Folder& folder, const Json& experiment) {
    Plan plan = planOf(folder, experiment);
    static const std::atomic<bool> never = false;
    Progress progress(true);
    runPlan(plan, {folder / "run", 1, false}, never, progress);
    return replicatesOf(plan);
}

}  // namespace

TEST_CASE("replicates are added to what is open, up to the most", "[sequential]") {
    const Folder folder;
    const Json experiment = openQuestion(0.001);
    CHECK(planOf(folder, experiment).design.looks == 3);  // at 5, 10 and 15
    const auto found = replicatesAfter(folder, experiment);
    CHECK(found.at("path") == 15);
    CHECK(found.at("again") == 15);
    CHECK(found.at("other") < 15);
    const Json resolved = JsonDocument::fromFile(folder / "run/resolved.json").root().json();
    for (const Json& cell : resolved["cells"]) {
        CHECK(cell["replicates"] == found.at(cell["sampler"].get<std::string>()));
        CHECK(cell["random_keys"].size() == cell["replicates"]);
    }
    // Gone on with, it comes to the same without rendering anything.
    Plan again = planOf(folder, experiment);
    static const std::atomic<bool> never = false;
    Progress progress(true);
    const RunOutcome outcome = runPlan(again, {folder / "run", 1, false}, never, progress);
    CHECK(outcome.rendered == 0);
    CHECK(replicatesOf(again) == found);

    const Json summary = summarize(again, folder / "run", {});
    for (const Json& comparison : summary["comparisons"]) {
        CHECK(comparison["looks"] == 3);
        CHECK(comparison["p_adjusted"].get<double>() >= std::min(1.0, 3 * comparison["p"].get<double>()));
        CHECK(comparison["verdict"] == (comparison["sampler"] == "other" ? "worse" : "undecided"));
    }
}

TEST_CASE("cells that open late catch up, so that there are no more looks than planned", "[sequential]") {
    const Folder folder;
    const Json experiment = openQuestion(0.001);
    replicatesAfter(folder, experiment);
    Plan plan = planOf(folder, experiment);
    const auto countOf = [&](const std::string& sampler) -> int& {
        return std::ranges::find(plan.cells, sampler, [](const Cell& c) { return c.task.sampler; })->task.replicates;
    };
    countOf("again") = 10;
    CHECK(addReplicates(plan, folder / "run") == 10 + 5);
    CHECK(countOf("path") == 15);
    CHECK(countOf("again") == 15);
    // The last look was at what some cell had the most of.
    countOf("path") = 10;
    CHECK(addReplicates(plan, folder / "run") == 0);
}

TEST_CASE("a ratio that is known well enough gets no more", "[sequential]") {
    const Folder folder;
    const auto found = replicatesAfter(folder, openQuestion(1));
    CHECK(found.at("path") == 5);
    CHECK(found.at("again") == 5);
}

TEST_CASE("without a baseline the mean errors are what is asked for", "[sequential]") {
    const Folder folder;
    Json experiment = openQuestion(0.001);
    experiment.erase("baseline");
    CHECK(replicatesAfter(folder, experiment).at("other") == 15);
    const Folder other;
    experiment["until"]["relative_ci"] = 1;
    CHECK(replicatesAfter(other, experiment).at("other") == 5);
}

TEST_CASE("a poor reference is not waited for", "[sequential]") {
    const Folder folder;
    Json experiment = openQuestion(0.001);
    experiment["reference"]["budget"]["spp"] = 16;
    experiment["reference"]["part"]["spp"] = 4;
    CHECK(replicatesAfter(folder, experiment).at("path") == 5);
}

TEST_CASE("with common random numbers equal samplers make equal images", "[sequential]") {
    const Folder folder;
    Json experiment = openQuestion(1);
    experiment.erase("until");
    experiment["common_random_numbers"] = true;
    const Plan plan = planOf(folder, experiment);
    runIn(folder, plan);
    const Json summary = summarize(plan, folder / "run", {});
    for (const Json& comparison : summary["comparisons"]) {
        CHECK(comparison["paired"] == true);
        if (comparison["sampler"] != "again") continue;
        CHECK(comparison["ratio"] == 1);
        CHECK(comparison["ci95"] == Json::array({1.0, 1.0}));
        CHECK(comparison["p"] == 1);
        CHECK(comparison["verdict"] == "undecided");
    }

    // A replicate without a partner is no pair.
    std::filesystem::remove_all(folder / "run/cells/wall-again/r002");
    const Json incomplete = summarize(plan, folder / "run", {});
    for (const Json& comparison : incomplete["comparisons"])
        if (comparison["sampler"] == "again") CHECK(comparison["ratio"] == 1);
}
