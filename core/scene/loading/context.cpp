#include "core/scene/loading/context.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/image/image_io.h"

namespace ulam {
namespace {

constexpr std::size_t kLargestFile = std::size_t(4) << 30;

}  // namespace

SceneFile findSceneFile(const std::filesystem::path& folder, const std::string& name) {
    namespace fs = std::filesystem;
    const fs::path path = name, file = folder / path;
    if (path.empty()) return {file, "the name of the file is empty", ""};
    if (path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end())
        return {file, "the path leaves the folder of the scene", "give a path below that folder"};
    std::error_code failed;
    // Links may lead out of the folder too, and pipes and devices need not end.
    const fs::path inside = fs::relative(fs::weakly_canonical(file, failed), fs::weakly_canonical(folder / ".", failed), failed);
    if (failed || (!inside.empty() && *inside.begin() == ".."))
        return {file, "the path leaves the folder of the scene by a link", "give a file below that folder"};
    if (fs::exists(file, failed) && !fs::is_regular_file(file, failed)) return {file, fmt::format("{} is no regular file", file.string()), ""};
    return {file, "", ""};
}

std::filesystem::path LoadContext::locate(const JsonNode& filename) const {
    const SceneFile file = findSceneFile(folder, filename.string());
    if (!file.refusal.empty()) filename.fail(file.refusal, file.hint);
    return file.path;
}

std::string LoadContext::read(const JsonNode& filename) {
    const std::filesystem::path file = locate(filename);
    try {
        std::string bytes = readFile(file, kLargestFile);
        fileHashes.push_back(sha256(bytes));
        return bytes;
    } catch (const Error& error) {
        fail(error.code(), "{} (named at {})", error.what(), filename.where());
    }
}

Image LoadContext::readImage(const JsonNode& filename, bool raw) {
    read(filename);  // for the hash
    try {
        return ulam::readImage(locate(filename).string(), raw ? Encoding::Raw : Encoding::ByFormat);
    } catch (const Error& error) {
        fail(error.code(), "{} (named at {})", error.what(), filename.where());
    }
}

}  // namespace ulam
