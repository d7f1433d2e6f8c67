#include "experiments/engine/scene_store.h"

#include <algorithm>
#include <list>
#include <mutex>

#include "core/base/error.h"
#include "core/base/memory.h"

namespace ulam {
namespace {

std::mutex sceneMutex;
std::list<std::shared_ptr<const Scene>> keptScenes;  ///< the one used last is the first

std::shared_ptr<const Scene> buildAndKeep(const BuildScene& build) {
    if (memoryIsLimited()) keptScenes.clear();
    keptScenes.push_front(std::make_shared<const Scene>(build()));
    double bytes = totalBytes(keptScenes.front()->memory());
    const auto fits = [&](const auto& scene) { return (bytes += totalBytes(scene->memory())) <= kKeptSceneBytes; };
    keptScenes.erase(std::find_if_not(std::next(keptScenes.begin()), keptScenes.end(), fits), keptScenes.end());
    return keptScenes.front();
}

}  // namespace

std::shared_ptr<const Scene> newScene(const BuildScene& build) {
    const std::lock_guard lock(sceneMutex);
    return buildAndKeep(build);
}

std::shared_ptr<const Scene> sceneFor(const std::string& hash, const BuildScene& build) {
    const std::lock_guard lock(sceneMutex);
    const auto known = std::ranges::find(keptScenes, hash, [](const auto& scene) { return scene->hash; });
    if (known != keptScenes.end()) {
        keptScenes.splice(keptScenes.begin(), keptScenes, known);
        return keptScenes.front();
    }
    auto scene = buildAndKeep(build);
    if (scene->hash != hash)
        fail(ExitCode::InvalidConfig,
             "files of a scene have changed since the run was planned: begin anew with another -o");
    return scene;
}

}  // namespace ulam
