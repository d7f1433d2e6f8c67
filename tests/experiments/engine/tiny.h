#pragma once
// An experiment that takes no time: a lit wall, 16 × 16 pixels, few samples; and folders of its own.

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>

#include "core/base/error.h"
#include "core/base/file.h"
#include "experiments/engine/run.h"
#include "experiments/engine/summary.h"
#include "tests/support/error_of.h"

namespace ulam::tests {

/// An empty folder, gone at the end of its scope. The cache of references is in it, so that tests share nothing.
struct Folder {
    std::filesystem::path path;

    Folder() {
        static int count = 0;
        path = std::filesystem::temp_directory_path() / fmt::format("ulam-engine-test-{}-{}", ::getpid(), count++);
        std::filesystem::remove_all(path);
        std::filesystem::create_directories(path);
        ::setenv("XDG_CACHE_HOME", (path / "cache").c_str(), 1);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    std::filesystem::path operator/(const std::string& name) const { return path / name; }
};

inline Json tinyScene() {
    return Json::parse(R"({
        "type": "scene",
        "sensor": {"type": "perspective", "fov": 60, "to_world": [{"type": "lookat", "origin": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0]}]},
        "wall": {"type": "rectangle", "to_world": [{"type": "scale", "value": 3}]},
        "lamp": {"type": "rectangle", "emitter": {"type": "area", "radiance": 4},
                 "to_world": [{"type": "rotate", "axis": [1, 0, 0], "angle": 180}, {"type": "translate", "value": [2.5, 0, 2]}]}
    })");
}

/// `path` against `bdpt` with 4 samples a pixel and 3 replicates.
inline Json tinyExperiment() {
    return {{"name", "tiny"},
            {"scenes", {{"wall", tinyScene()}}},
            {"film", {{"width", 16}, {"height", 16}}},
            {"max_depth", 3},
            {"samplers", {{"path", {{"type", "path"}}}, {"bdpt", {{"type", "bdpt"}}}}},
            {"baseline", "path"},
            {"budget", {{"spp", 4}}},
            {"replicates", 3},
            {"snapshots", 2},
            {"metrics", {"relmse", "flip"}},
            {"reference", {{"sampler", "bdpt"}, {"budget", {{"spp", 256}}}, {"part", {{"spp", 32}}}}}};
}

/// The same of four like holes before an emitter, whose image is known.
inline Json fourHoles() {
    Json experiment = tinyExperiment();
    experiment["scenes"] = {
        {"emitter", {{"type", "grid_of_holes"}, {"holes", 2}, {"back", "emitter"}, {"thickness", 0}}}};
    experiment["film"]["rfilter"] = {{"type", "box"}};
    experiment["reference"] = "truth";
    experiment["max_depth"] = 2;
    return experiment;
}

/// Written to a file and planned from there, as the program does.
inline Plan planOf(const Folder& folder, const Json& experiment) {
    const std::filesystem::path file = folder / "experiment.json";
    writeFileAtomically(file, experiment.dump(2));
    return makePlan(JsonDocument::fromFile(file), file);
}

/// Of a copy of the plan, which does not tell of replicates that were added.
inline RunOutcome runIn(const Folder& folder, Plan plan, bool keepGoing = false) {
    static const std::atomic<bool> never = false;
    Progress progress(true);
    return runPlan(plan, {folder / "run", 1, keepGoing}, never, progress);
}

}  // namespace ulam::tests
