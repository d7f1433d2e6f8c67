#pragma once
// What `ulam render` is to do, from its command line or from the result of an earlier run.

#include <optional>
#include <string>
#include <vector>

#include "core/render/driver.h"
#include "experiments/cli/arguments.h"
#include "experiments/engine/result.h"

namespace ulam {

struct RenderJob {
    JsonDocument scene;
    std::filesystem::path folder;  ///< where relative paths in the scene start from
    Json film;                     ///< options above the scene's own
    JsonDocument sampler;
    Budget budget;
    RunIdentity run = {};  ///< as far as it is known before the scene is built
};

struct RenderWishes {
    std::string scene, sampler;
    SceneFileOptions options;
    std::vector<std::string> assignments;  ///< `--set`: each goes to the sampler, the scene or its film
    Budget budget;
    std::uint64_t seed = 1;
};
RenderJob renderJob(const RenderWishes& wishes);

/// Builds the job's scene. Where the film is refused, the `--set` that is to blame is named.
Scene buildScene(const RenderJob& job, const std::vector<std::string>& assignments);

/// Scene, sampler and budget that a result has under "repeat".
RenderJob jobOf(const JsonNode& repeat);

/// The run that a result.json is of, with the work it did as its budget.
struct Repetition {
    RenderJob job;
    std::string sceneHash, imageHash, version;  ///< of the run
    Json simd;                                  ///< its vector instructions; null: they are not known
};
Repetition repetition(const std::filesystem::path& result);

}  // namespace ulam
