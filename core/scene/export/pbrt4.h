#pragma once
// Scenes for pbrt-v4: its text format, with meshes as PLY files.

#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/load.h"

namespace ulam {

/// Writes scene.pbrt, meshes/ and textures/ into a folder as exportMitsuba3 does. Shapes are written where they stand
/// in the world; an environment map becomes an octahedral picture. Returns a line for everything that was left out or
/// written as something else.
std::vector<std::string> exportPbrt4(const SceneDescription& description, const std::filesystem::path& folder);

}  // namespace ulam
