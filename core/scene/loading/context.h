#pragma once
// What readers of plugins need besides their dictionary.

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/json.h"
#include "core/image/image.h"

namespace ulam {

/// A file that a scene names, or why it may not name it.
struct SceneFile {
    std::filesystem::path path;
    std::string refusal, hint;  ///< empty: the path is good, though the file may be missing
};
/// Paths start at the scene's folder and may not leave it, by links neither; what is no regular file is refused.
SceneFile findSceneFile(const std::filesystem::path& folder, const std::string& name);

struct LoadContext {
    std::filesystem::path folder;  ///< of the scene file
    std::vector<std::string> warnings;
    std::vector<std::string> fileHashes;  ///< SHA-256 of the files that were read, in order

    /// The bytes of a file of the scene. A path that leaves the scene's folder fails, as does a missing file.
    std::string read(const JsonNode& filename);
    /// The same of a picture; `raw` as in image_io.h. Pictures that are damaged, too large or hold NaN fail.
    Image readImage(const JsonNode& filename, bool raw);

private:
    std::filesystem::path locate(const JsonNode& filename) const;
};

}  // namespace ulam
