#include "experiments/engine/estimate.h"

#include "experiments/engine/replicate.h"
#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;

namespace {

double bytesBelow(const std::filesystem::path& folder) {
    double bytes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) bytes += double(entry.file_size());
    return bytes;
}

}  // namespace

TEST_CASE("the estimate of a time budget is the budget", "[estimate]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["budget"] = {{"time", 7}};
    CHECK(estimateReplicate(planOf(folder, experiment).cells[0].task, 1).seconds == 7);
    experiment["budget"] = {{"time", 7}, {"spp", 1}};
    CHECK(estimateReplicate(planOf(folder, experiment).cells[0].task, 1).seconds < 1);
}

TEST_CASE("replicates take the time and the space that was estimated", "[estimate][speed]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["samplers"] = {{"bdpt", {{"type", "bdpt"}}}, {"mlt", {{"type", "mlt"}}}};
    experiment["baseline"] = "bdpt";
    experiment["budget"] = {{"spp", 6000}};
    experiment["snapshots"] = 3;
    const Plan plan = planOf(folder, experiment);
    static const std::atomic<bool> never = false;
    for (const Cell& cell : plan.cells) {
        CAPTURE(cell.task.name);
        const Cost estimate = estimateReplicate(cell.task, 1);
        REQUIRE(renderReplicate(cell.task, 0, folder / cell.task.name, 1, never, {}));
        const Json result = JsonDocument::fromFile(folder / (cell.task.name + "/r000/result.json")).root().json();
        // Other work on the machine changes its speed: a wrong model is wrong by more.
        CHECK(estimate.seconds == Approx(result["wall_seconds"].get<double>()).epsilon(0.5));
        CHECK(estimate.bytes == Approx(bytesBelow(folder / cell.task.name)).epsilon(0.15));
    }
}

TEST_CASE("of many cells some are tried", "[estimate][speed]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["snapshots"] = 0;
    experiment["budget"] = {{"spp", 1}};
    experiment["samplers"] = {{"path", {{"type", "path"}}}, {"same", {{"type", "path"}}}};
    experiment["baseline"] = "path";
    experiment["sweep"] = {{"budget.spp", {{"linear", {10, 2000}}, {"steps", 100}}}};
    const Plan plan = planOf(folder, experiment);
    REQUIRE(plan.cells.size() == 200);
    const PlanEstimate estimate = estimatePlan(plan, 1);
    CHECK(estimate.tried == kTriedCells);
    double path = 0, same = 0;
    for (std::size_t c = 0; c < plan.cells.size(); ++c) {
        const double seconds = estimate.cells[c].seconds;
        CHECK(seconds > 0);
        (plan.cells[c].task.sampler == "path" ? path : same) += seconds;
    }
    // Cells alternate between the samplers, and budgets rise: trials at regular steps would know one of each.
    CHECK(same == Approx(path).epsilon(0.5));
    const Cost total = estimate.total(plan);
    CHECK(total.seconds > 0);
    CHECK(total.bytes > 200 * 3 * 1000.0);
}
