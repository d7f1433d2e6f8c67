#pragma once
// The scenes of a run that are in memory: a sweep over a scene's knobs may have more of them than memory holds.

#include <functional>
#include <memory>
#include <string>

#include "core/scene/scene.h"

namespace ulam {

/// What is kept: the scenes used last, together at most these bytes, and in any case the last one. Where --max-memory
/// limits the process, that one alone.
inline constexpr double kKeptSceneBytes = 2.0 * 1024 * 1024 * 1024;

using BuildScene = std::function<Scene()>;

/// Builds a scene and keeps it.
std::shared_ptr<const Scene> newScene(const BuildScene& build);

/// The scene of this hash, which is built where it is not kept. Fails where a scene of another hash is built: its files
/// have changed.
std::shared_ptr<const Scene> sceneFor(const std::string& hash, const BuildScene& build);

}  // namespace ulam
