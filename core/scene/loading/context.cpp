#include "core/scene/loading/context.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/sha256.h"

namespace ulam {

std::string LoadContext::read(const JsonNode& filename) {
    const std::filesystem::path path = filename.string();
    if (path.empty()) filename.expected("the name of a file");
    if (path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end())
        filename.fail("the path leaves the folder of the scene", "give a path below that folder");
    try {
        std::string bytes = readFile(folder / path);
        fileHashes.push_back(sha256(bytes));
        return bytes;
    } catch (const Error& error) {
        fail(error.code(), "{} (named at {})", error.what(), filename.where());
    }
}

}  // namespace ulam
