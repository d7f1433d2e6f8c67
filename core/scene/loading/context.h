#pragma once
// What readers of plugins need besides their dictionary.

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/json.h"
#include "core/image/image.h"

namespace ulam {

struct LoadContext {
    std::filesystem::path folder;  ///< of the scene file
    std::vector<std::string> warnings;
    std::vector<std::string> fileHashes;  ///< SHA-256 of the files that were read, in order

    /// The bytes of a file of the scene. A path that findSceneFile refuses fails, as does a missing file.
    std::string read(const JsonNode& filename);
    /// The same of a picture; `raw` as in image_io.h. Pictures that are damaged, too large or hold NaN fail.
    Image readImage(const JsonNode& filename, bool raw);

private:
    std::filesystem::path locate(const JsonNode& filename) const;
};

}  // namespace ulam
