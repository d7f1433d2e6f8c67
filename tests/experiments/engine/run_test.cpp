#include "experiments/engine/run.h"

#include <set>

#include "core/image/image_io.h"
#include "core/render/sampler.h"
#include "experiments/engine/replicate.h"
#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;
namespace fs = std::filesystem;

namespace {

/// Fails in every run whose random key is the one given.
class FailingSampler : public Sampler {
public:
    struct Parameters {
        std::uint32_t key = 0;
        template <class V>
        void describe(V& v) {
            v("key", key, {.help = "low word of the random key that fails; 0: all"});
        }
    };
    explicit FailingSampler(const Parameters& p) : parameters_(p) {}

    std::unique_ptr<SamplerRun> start(const RunContext& context) const override {
        if (parameters_.key == 0 || context.key.low == parameters_.key)
            fail(ExitCode::InvalidConfig, "failed on purpose");
        return Registry<Sampler>::instance().create(JsonNode(Json{{"type", "path"}}))->start(context);
    }

private:
    Parameters parameters_;
};
ULAM_REGISTER_SAMPLER(FailingSampler, "failing", "for tests");

fs::path resultOf(const Folder& folder, const std::string& cell, int replicate) {
    return replicateFolder(folder / "run" / "cells" / cell, replicate) / "result.json";
}

}  // namespace

TEST_CASE("a run leaves every file of every replicate", "[run]") {
    const Folder folder;
    const RunOutcome outcome = runIn(folder, planOf(folder, tinyExperiment()));
    CHECK(outcome.rendered == 6);
    CHECK(outcome.reused == 0);
    for (const char* file : {"experiment.json", "resolved.json", "provenance.json"})
        CHECK(fs::exists(folder / "run" / file));
    for (const char* cell : {"wall-path", "wall-bdpt"}) {
        for (int r = 0; r < 3; ++r) {
            const Json result = JsonDocument::fromFile(resultOf(folder, cell, r)).json();
            for (const char* key : {"schema_version",
                                    "scene",
                                    "sampler",
                                    "parameters",
                                    "seed",
                                    "replicate",
                                    "threads",
                                    "wall_seconds",
                                    "cpu_seconds",
                                    "setup_seconds",
                                    "seeding_seconds",
                                    "rays",
                                    "samples",
                                    "mutations",
                                    "chains",
                                    "normalization",
                                    "normalization_std_error",
                                    "mutation_statistics",
                                    "non_finite",
                                    "bias_ledger",
                                    "peak_rss_bytes",
                                    "image_sha256",
                                    "units",
                                    "snapshots",
                                    "feature_energy"})
                CHECK(result.contains(key));
            CHECK(result["snapshots"].size() == 2);
            CHECK(result["samples"] == 4 * 256);
            const Image image = readImage(resultOf(folder, cell, r).parent_path() / "image.exr");
            CHECK(result["image_sha256"] == imageHash(image));
            CHECK(readImageAttributes(resultOf(folder, cell, r).parent_path() / "image.exr").at("ulam:scene_hash") ==
                  result["scene_hash"]);
        }
    }
}

TEST_CASE("resuming redoes what is missing and nothing else", "[run]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    runIn(folder, plan);
    const auto untouched = fs::last_write_time(resultOf(folder, "wall-path", 0));
    const std::string before = JsonDocument::fromFile(resultOf(folder, "wall-bdpt", 1)).json()["image_sha256"];

    fs::remove(resultOf(folder, "wall-bdpt", 1));
    writeFileAtomically(resultOf(folder, "wall-bdpt", 2), "{ damaged");
    const RunOutcome outcome = runIn(folder, plan);
    CHECK(outcome.rendered == 2);
    CHECK(outcome.reused == 4);
    CHECK(fs::last_write_time(resultOf(folder, "wall-path", 0)) == untouched);
    CHECK(JsonDocument::fromFile(resultOf(folder, "wall-bdpt", 1)).json()["image_sha256"] == before);

    // A larger budget makes every replicate anew, more replicates only the new ones.
    Json experiment = tinyExperiment();
    experiment["replicates"] = 4;
    CHECK(runIn(folder, planOf(folder, experiment)).rendered == 2);
    experiment["budget"]["spp"] = 5;
    CHECK(runIn(folder, planOf(folder, experiment)).reused == 0);
}

TEST_CASE("a damaged replicate is done again", "[run]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    runIn(folder, plan);
    const fs::path result = resultOf(folder, "wall-path", 1), replicate = result.parent_path();
    const Json intact = JsonDocument::fromFile(result).json();
    const Task& task = plan.cells[0].task;
    REQUIRE(task.name == "wall-path");
    const auto check = [&](const std::string& reason) {
        std::string damage;
        CHECK_FALSE(finishedReplicate(task, 1, folder / "run" / "cells" / "wall-path", &damage));
        CHECK(mentions(damage, reason));
        CHECK(runIn(folder, plan).rendered == 1);
        CHECK(JsonDocument::fromFile(result).json()["image_sha256"] == intact["image_sha256"]);
    };
    for (const auto& [key, value] :
         std::vector<std::pair<std::string, Json>>{{"task_hash", 3},
                                                   {"replicate", "one"},
                                                   {"image_sha256", "0"},
                                                   {"image_sha256", nullptr},
                                                   {"wall_seconds", "long"},
                                                   {"feature_energy", 1},
                                                   {"non_finite", {{"radiance", -1}}},
                                                   {"mutation_statistics", {{"lens", {{"proposed", 1}}}}},
                                                   {"snapshots", Json::array()},
                                                   {"snapshots", {1, 2}}}) {
        Json damaged = intact;
        damaged[key] = value;
        writeFileAtomically(result, damaged.dump());
        check(key);
    }
    writeFileAtomically(result, "[]");
    check("an object");

    writeExr(replicate / "image.exr", Image(16, 16, Rgb(1)));
    check("image.exr");
    writeFileAtomically(replicate / "image.exr", "text");
    check("image.exr");
    fs::remove(replicate / "image.exr");
    check("image.exr");
    writeExr(replicate / "snapshots/s01.exr", Image(8, 8, Rgb(1)));
    check("s01.exr");
    fs::remove(replicate / "snapshots/s00.exr");
    check("s00.exr");

    // What another task made is no damage.
    Json other = intact;
    other["task_hash"] = "another";
    writeFileAtomically(result, other.dump());
    std::string damage;
    CHECK_FALSE(finishedReplicate(task, 1, folder / "run" / "cells" / "wall-path", &damage));
    CHECK(damage.empty());
    CHECK(runIn(folder, plan).rendered == 1);
}

TEST_CASE("what killed processes left is removed, what others write is not", "[run]") {
    const Folder folder;
    const fs::path cell = folder / "run" / "cells" / "wall-path";
    fs::create_directories(cell);
    const std::string host = hostName();
    const auto temporary = [](const std::string& of, int64_t process, int number) {
        return fmt::format(".ulam-{}-{}-{}.tmp", of, process, number);
    };
    constexpr int64_t kEnded = 99'999'999;  // above the largest number a process can have
    const std::vector<fs::path> gone = {folder / "run" / temporary(host, kEnded, 0), cell / temporary(host, kEnded, 12),
                                        cell / temporary(host, ::getpid(), 3)};
    const std::vector<fs::path> kept = {cell / temporary(host, ::getppid(), 3), cell / fmt::format(".ulam-{}-{}.tmp", host, kEnded),
                                        cell / (temporary(host, kEnded, 0) + ".exr"), cell / temporary(host, kEnded, 0).substr(1),
                                        cell / temporary(host, -1, 0),
                                        // Of other hosts, one whose name begins as this one's.
                                        cell / temporary(host + "-1", kEnded, 0), cell / temporary("x" + host, kEnded, 0)};
    CHECK(temporaryName().starts_with(fmt::format(".ulam-{}-{}-", host, ::getpid())));
    for (const fs::path& file : gone) writeFileAtomically(file, "half");
    for (const fs::path& file : kept) writeFileAtomically(file, "whole");
    removeTemporaries(folder / "run");
    for (const fs::path& file : gone) CHECK_FALSE(fs::exists(file));
    for (const fs::path& file : kept) CHECK(fs::exists(file));
    removeTemporaries(folder / "none");
}

TEST_CASE("a signal stops a run and keeps what is finished", "[run]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["budget"] = {{"spp", 64}};
    Plan plan = planOf(folder, experiment);
    runIn(folder, plan);
    fs::remove(resultOf(folder, "wall-bdpt", 1));
    static const std::atomic<bool> stop = true;
    Progress progress(true);
    const RunOutcome outcome = runPlan(plan, {folder / "run", 1, false}, stop, progress);
    CHECK(outcome.interrupted);
    CHECK(outcome.rendered == 0);
    CHECK_FALSE(fs::exists(resultOf(folder, "wall-bdpt", 1)));
    CHECK(runIn(folder, plan).rendered == 1);
}

TEST_CASE("a failing replicate ends the run, or is reported while the others go on", "[run]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["samplers"]["broken"] = {{"type", "failing"}};
    // The key of one replicate of its cell; the cell's name decides, not its parameters.
    const Plan probe = planOf(folder, experiment);
    experiment["samplers"]["broken"]["key"] = probe.cells.back().task.key(1).low;
    const Plan plan = planOf(folder, experiment);

    const auto [code, message] = errorOf([&] { runIn(folder, plan); });
    CHECK(code == ExitCode::InvalidConfig);
    CHECK(mentions(message, "wall-broken, replicate 2"));
    CHECK(mentions(message, "failed on purpose"));

    const RunOutcome outcome = runIn(folder, plan, true);
    REQUIRE(outcome.failures.size() == 1);
    CHECK(outcome.failures[0].cell == "wall-broken");
    CHECK(outcome.failures[0].replicate == 1);
    CHECK(outcome.rendered + outcome.reused == 8);
    const Json summary = summarize(plan, folder / "run", outcome.failures);
    CHECK(summary["cells"][2]["replicates"] == 2);
    CHECK(summary["failures"][0]["message"] == "failed on purpose");
    CHECK(summary["failures"][0]["replicate"] == 1);
    // To people it is the second one, as in the progress.
    CHECK(mentions(summary["warnings"].dump(), "wall-broken: replicate 2 failed"));
}

TEST_CASE("a failing reference ends the run, or its scene is reported while the others go on", "[run]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["scenes"]["other"] = tinyScene();
    experiment["reference"] = {{"wall", experiment["reference"]},
                               {"other", {{"sampler", {{"type", "failing"}}}, {"budget", {{"spp", 64}}}}}};
    const Plan plan = planOf(folder, experiment);
    CHECK(mentions(errorOf([&] { runIn(folder, plan); }).message, "failed on purpose"));

    const RunOutcome outcome = runIn(folder, plan, true);
    CHECK(outcome.rendered == 6);
    REQUIRE(outcome.failures.size() == 3);
    CHECK(outcome.failures[0].scene == "other");
    CHECK(outcome.failures[0].cell.empty());
    CHECK(outcome.failures[0].message == "failed on purpose");
    for (const std::size_t i : {1, 2}) {
        CHECK(mentions(outcome.failures[i].cell, "other-"));
        CHECK_FALSE(outcome.failures[i].replicate);
    }
    CHECK_FALSE(fs::exists(resultOf(folder, "other-path", 0)));

    const Json summary = summarize(plan, folder / "run", outcome.failures);
    REQUIRE(summary["cells"].size() == 2);
    CHECK(summary["cells"][0]["scene"] == "wall");
    CHECK(summary["comparisons"].size() == 1);
    CHECK(summary["failures"][0]["cell"].is_null());
    CHECK(summary["failures"][1]["replicate"].is_null());
    CHECK(mentions(summary["warnings"].dump(), "the reference of other failed: failed on purpose"));
    CHECK(mentions(summary["warnings"].dump(), "other-bdpt failed: its reference failed"));
}

TEST_CASE("a reference that cannot be written ends the run in any case", "[run]") {
    const Folder folder;
    fs::create_directories(folder / "run");
    writeFileAtomically(folder / "run" / "references", "a file");
    const Plan plan = planOf(folder, tinyExperiment());
    CHECK(errorOf([&] { runIn(folder, plan, true); }).code == ExitCode::CannotWrite);
}

TEST_CASE("a folder that cannot be written ends the run at once", "[run]") {
    const Folder folder;
    writeFileAtomically(folder / "run", "a file");
    const Plan plan = planOf(folder, tinyExperiment());
    CHECK(errorOf([&] { runIn(folder, plan, true); }).code == ExitCode::CannotWrite);
}

TEST_CASE("the number of threads does not change an image", "[run]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    static const std::atomic<bool> never = false;
    const Task& task = plan.cells[1].task;
    std::set<std::string> hashes;
    for (int threads = 1; threads <= 3; ++threads) {
        const fs::path out = folder / fmt::format("threads-{}", threads);
        REQUIRE(renderReplicate(task, 0, out, threads, never, {}));
        hashes.insert(JsonDocument::fromFile(replicateFolder(out, 0) / "result.json").json()["image_sha256"]);
    }
    CHECK(hashes.size() == 1);
}
