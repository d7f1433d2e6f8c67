#pragma once
// Scenes for Mitsuba: its XML, with meshes as PLY files.

#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/load.h"

namespace ulam {

/// Writes scene.xml, meshes/ and textures/ into a folder, which is made, or replaced where it holds an earlier export
/// (see ExportFolder). Files that the scene names are copied. Returns a line for everything that was left out
/// or written as something else (nearest.h).
std::vector<std::string> exportMitsuba3(const SceneDescription& description, const std::filesystem::path& folder);
/// The same in the words of Mitsuba 0.6. `mitsuba -D integrator=mlt scene.xml` chooses the integrator; without it, path.
std::vector<std::string> exportMitsuba06(const SceneDescription& description, const std::filesystem::path& folder);

}  // namespace ulam
