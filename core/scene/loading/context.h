#pragma once
// What readers of plugins need besides their dictionary.

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/json.h"

namespace ulam {

struct LoadContext {
    std::filesystem::path folder;  ///< of the scene file
    std::vector<std::string> warnings;
    std::vector<std::string> fileHashes;  ///< SHA-256 of the files that were read, in order

    /// The bytes of a file of the scene. A path that leaves the scene's folder fails, as does a missing file.
    std::string read(const JsonNode& filename);
};

}  // namespace ulam
