#include "experiments/engine/scene_store.h"

#include <algorithm>
#include <list>
#include <mutex>

#include "core/base/error.h"
#include "core/base/memory.h"

namespace ulam {
namespace {

std::mutex mutex;
std::list<std::shared_ptr<const Scene>> kept;  ///< the one used last is the first

std::shared_ptr<const Scene> buildAndKeep(const BuildScene& build) {
    if (memoryIsLimited()) kept.clear();
    kept.push_front(std::make_shared<const Scene>(build()));
    double bytes = totalBytes(kept.front()->memory());
    const auto fits = [&](const auto& scene) { return (bytes += totalBytes(scene->memory())) <= kKeptSceneBytes; };
    kept.erase(std::find_if_not(std::next(kept.begin()), kept.end(), fits), kept.end());
    return kept.front();
}

}  // namespace

std::shared_ptr<const Scene> newScene(const BuildScene& build) {
    const std::lock_guard lock(mutex);
    return buildAndKeep(build);
}

std::shared_ptr<const Scene> sceneFor(const std::string& hash, const BuildScene& build) {
    const std::lock_guard lock(mutex);
    const auto known = std::ranges::find(kept, hash, [](const auto& scene) { return scene->hash; });
    if (known != kept.end()) {
        kept.splice(kept.begin(), kept, known);
        return kept.front();
    }
    auto scene = buildAndKeep(build);
    if (scene->hash != hash)
        fail(ExitCode::InvalidConfig, "files of a scene have changed since the run was planned: begin anew with another -o");
    return scene;
}

}  // namespace ulam
