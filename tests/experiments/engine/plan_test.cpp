#include "experiments/engine/plan.h"

#include <limits>
#include <set>

#include "core/base/memory.h"
#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;

namespace {

std::set<std::string> cellNames(const Plan& plan) {
    std::set<std::string> names;
    for (const Cell& cell : plan.cells) names.insert(cell.task.name);
    return names;
}

}  // namespace

TEST_CASE("cells are scenes × samplers × what the sweep changes", "[plan]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["scenes"]["other"] = tinyScene();
    CHECK(cellNames(planOf(folder, experiment)) ==
          std::set<std::string>{"wall-path", "wall-bdpt", "other-path", "other-bdpt"});

    // A sampler that a sweep leaves alone is run once.
    experiment["sweep"] = {{"samplers.bdpt.rr_depth", {3, 4}}, {"scenes.other.lamp.emitter.radiance", {1, 2}}};
    const Plan plan = planOf(folder, experiment);
    CHECK(cellNames(plan) ==
          std::set<std::string>{"wall-path", "wall-bdpt,rr_depth=3", "wall-bdpt,rr_depth=4", "other-path,radiance=1",
                                "other-path,radiance=2", "other-bdpt,rr_depth=3,radiance=1",
                                "other-bdpt,rr_depth=3,radiance=2", "other-bdpt,rr_depth=4,radiance=1",
                                "other-bdpt,rr_depth=4,radiance=2"});
    CHECK(plan.comparisons.size() == 6);
    for (const PlannedComparison& c : plan.comparisons) {
        const Cell &cell = plan.cells[c.cell], &baseline = plan.cells[c.baseline];
        CHECK(cell.task.sampler == "bdpt");
        CHECK(baseline.task.sampler == "path");
        CHECK(cell.task.scene == baseline.task.scene);
    }
    CHECK(plan.references.size() == 3);
}

TEST_CASE("a sweep leads into the files of scenes", "[plan]") {
    const Folder folder;
    std::filesystem::create_directories(folder / "below");
    Json scene = tinyScene();
    scene["mesh"] = {{"type", "obj"}, {"filename", "mesh.obj"}};  // beside the scene
    writeFileAtomically(folder / "below/mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    writeFileAtomically(folder / "below/scene.json", scene.dump());
    Json experiment = tinyExperiment();
    experiment["scenes"]["wall"] = "below/scene.json";
    const std::string unchanged = planOf(folder, experiment).cells[0].task.scene->hash;
    for (const Json& sweep : {Json{{"scenes.wall.lamp.emitter.radiance", {4, 8}}}, Json{{"zip", {{"scenes.wall.lamp.emitter.radiance", {4, 8}}}}}}) {
        experiment["sweep"] = sweep;
        const Plan plan = planOf(folder, experiment);
        REQUIRE(plan.cells.size() == 4);
        CHECK(plan.cells[0].task.scene->hash == unchanged);
        CHECK(plan.cells[2].task.scene->hash != unchanged);
        CHECK(plan.experiment["scenes"]["wall"] == "below/scene.json");
    }
    experiment["sweep"] = {{"scenes.wall.lamp.emitter.radianc", {4}}};
    CHECK(mentions(errorOf([&] { planOf(folder, experiment); }).message, "did you mean \"radiance\"?"));
}

TEST_CASE("a scene is built again where others took its place, and is the same", "[plan]") {
    const Folder folder;
    Json scene = tinyScene();
    scene["mesh"] = {{"type", "obj"}, {"filename", "mesh.obj"}};
    writeFileAtomically(folder / "mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    Json experiment = tinyExperiment();
    experiment["scenes"]["wall"] = scene;
    experiment["sweep"] = {{"scenes.wall.lamp.emitter.radiance", {4, 8}}};
    limitMemory(std::uint64_t(1) << 40);  // one scene alone is kept
    const Plan plan = planOf(folder, experiment);
    const PlannedScene &first = *plan.cells[0].task.scene, &last = *plan.cells[3].task.scene;
    std::weak_ptr<const Scene> built = last.scene();
    CHECK(built.lock() == last.scene());
    CHECK(first.scene()->hash == first.hash);
    CHECK(built.expired());
    CHECK(last.scene()->hash == last.hash);
    writeFileAtomically(folder / "mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    CHECK(mentions(errorOf([&] { first.scene(); }).message, "files of a scene have changed"));
    limitMemory(std::numeric_limits<std::uint64_t>::max());
    const Plan changed = planOf(folder, experiment);
    built = changed.cells[0].task.scene->scene();
    CHECK(changed.cells[3].task.scene->scene() != built.lock());
    CHECK(changed.cells[0].task.scene->scene() == built.lock());
}

TEST_CASE("names of cells are short enough for file systems", "[plan]") {
    const Folder folder;
    const auto names = [&](int mutations) {
        Json experiment = tinyExperiment();
        Json mix = Json::object(), zip = Json::object();
        for (int m = 0; m < mutations; ++m) {
            const std::string name = fmt::format("large_step_{}", m);
            mix[name] = {{"type", "large_step"}};
            zip["samplers.p.mutations." + name + ".weight"] = {0.123456 + m, 0.234567 + m};
        }
        experiment["samplers"] = {{"p", {{"type", "pssmlt"}, {"mutations", mix}}}};
        experiment.erase("baseline");
        experiment["sweep"] = {{"zip", zip}};
        return cellNames(planOf(folder, experiment));
    };
    CHECK(names(2).contains("wall-p,samplers.p.mutations.large_step_0.weight=0.123456,samplers.p.mutations.large_step_1.weight=1.12346"));
    CHECK(names(5).contains("wall-p,large_step_0.weight=0.123456,large_step_1.weight=1.12346,large_step_2.weight=2.12346,"
                            "large_step_3.weight=3.12346,large_step_4.weight=4.12346"));
    const auto hashed = names(12);
    REQUIRE(hashed.size() == 2);
    for (const std::string& name : hashed) {
        CHECK(name.size() <= 200);
        CHECK(mentions(name, "large_step_4.weight="));
        CHECK(mentions(name, ",hash="));
    }
}

TEST_CASE("random numbers depend on seed, cell and replicate and on nothing else", "[plan]") {
    const Folder folder;
    const auto keys = [&](const Json& experiment) {
        std::map<std::string, std::pair<uint32_t, uint32_t>> all;
        for (const Cell& cell : planOf(folder, experiment).cells)
            for (int r = 0; r < cell.task.replicates; ++r)
                all[fmt::format("{} {}", cell.task.name, r)] = {cell.task.key(r).low, cell.task.key(r).high};
        return all;
    };
    const auto plain = keys(tinyExperiment());
    std::set<std::pair<uint32_t, uint32_t>> different;
    for (const auto& [name, key] : plain) different.insert(key);
    CHECK(different.size() == plain.size());

    // Another cell, another budget, more replicates: the old ones stay.
    Json larger = tinyExperiment();
    larger["samplers"]["aaa"] = {{"type", "path"}};
    larger["replicates"] = 5;
    larger["budget"]["spp"] = 9;
    const auto more = keys(larger);
    for (const auto& [name, key] : plain) CHECK(more.at(name) == key);

    Json reseeded = tinyExperiment();
    reseeded["seed"] = 2;
    for (const auto& [name, key] : keys(reseeded)) CHECK(plain.at(name) != key);

    // Recorded once: seeds must not change from version to version.
    const RandomKey first = planOf(folder, tinyExperiment()).cells[0].task.key(0);
    CHECK(first.low == 0x6c06682e);
    CHECK(first.high == 0x4215948c);
}

TEST_CASE("common random numbers are shared by cells and by nothing else", "[plan]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["common_random_numbers"] = true;
    experiment["sweep"] = {{"budget.spp", {2, 4}}};
    const Plan plan = planOf(folder, experiment);
    CHECK(plan.design.paired);
    REQUIRE(plan.cells.size() == 4);
    std::set<std::pair<uint32_t, uint32_t>> keys;
    for (const Cell& cell : plan.cells)
        for (int r = 0; r < cell.task.replicates; ++r) keys.insert({cell.task.key(r).low, cell.task.key(r).high});
    CHECK(keys.size() == 3);
    const RandomKey reference = plan.references[0].task.key(0);
    CHECK_FALSE(keys.contains({reference.low, reference.high}));
    CHECK(plan.cells[0].task.hash() != planOf(folder, tinyExperiment()).cells[0].task.hash());
}

TEST_CASE("blocks hold one replicate of every cell, in changing order", "[plan]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["replicates"] = 12;
    experiment["samplers"]["more"] = {{"type", "path"}};
    const Plan plan = planOf(folder, experiment);
    const auto order = plan.order();
    REQUIRE(order.size() == 36);
    std::set<std::vector<std::size_t>> orders;
    for (std::size_t block = 0; block < 12; ++block) {
        std::vector<std::size_t> cells;
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(order[3 * block + i].number == int(block));
            cells.push_back(order[3 * block + i].cell);
        }
        CHECK(std::set<std::size_t>(cells.begin(), cells.end()).size() == 3);
        orders.insert(cells);
    }
    CHECK(orders.size() > 2);
}

TEST_CASE("the smallest attainable p tells when replicates are too few", "[plan]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    CHECK(planOf(folder, experiment).smallestAdjustedP() == std::vector<double>{0.1});  // 2 of 20 splits
    experiment["replicates"] = 8;
    CHECK(planOf(folder, experiment).smallestAdjustedP()[0] < 2e-4);
}

TEST_CASE("everything that determines a replicate is in the task's hash", "[plan]") {
    const Folder folder;
    const auto hash = [&](const std::string& path, const Json& value) {
        Json experiment = tinyExperiment();
        if (!path.empty()) setValueByPath(experiment, path, value);
        return planOf(folder, experiment).cells[0].task.hash();
    };
    const std::string plain = hash("", {});
    CHECK(hash("replicates", 9) == plain);
    CHECK(hash("metrics", {"mse"}) == plain);
    CHECK(hash("budget.spp", 5) != plain);
    CHECK(hash("seed", 5) != plain);
    CHECK(hash("max_depth", 4) != plain);
    CHECK(hash("film.width", 8) != plain);
    CHECK(hash("snapshots", 1) != plain);
    CHECK(hash("samplers.path.rr_depth", 7) != plain);
    CHECK(hash("scenes.wall.lamp.emitter.radiance", 7) != plain);
}

TEST_CASE("the resolved experiment holds defaults, seeds and hashes", "[plan]") {
    const Folder folder;
    const Json resolved = planOf(folder, tinyExperiment()).resolved();
    const Json& cell = resolved["cells"][0];
    CHECK(cell["parameters"].contains("rr_depth"));
    CHECK(cell["random_keys"].size() == 3);
    CHECK(resolved["scenes"].contains(cell["scene_hash"].get<std::string>()));
    CHECK(resolved["references"].contains(cell["reference"].get<std::string>()));
}
