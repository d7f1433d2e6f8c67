#pragma once
// Which files a scene may name.

#include <filesystem>
#include <string>

namespace ulam {

/// A file that a scene names, or why it may not name it.
struct SceneFile {
    std::filesystem::path path;
    std::string refusal, hint;  ///< empty: the path is good, though the file may be missing
};

/// From now on scenes may name files in this folder and below it too (`--resource-path`). An allowance of the whole program:
/// the command line gives it once, before anything is read. Fails with InputMissing where there is no such folder.
void allowFilesFrom(const std::filesystem::path& folder);

/// A relative name starts at the scene's folder or, where nothing is there, at one of the allowed folders, in their order.
/// Wherever a name leads, by ".." or links too, must be in one of these folders; what is no regular file is refused.
SceneFile findSceneFile(const std::filesystem::path& folder, const std::string& name);

}  // namespace ulam
