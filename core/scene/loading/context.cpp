#include "core/scene/loading/context.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/image/image_io.h"
#include "core/scene/loading/scene_file.h"

namespace ulam {
namespace {

constexpr std::size_t kLargestFile = std::size_t(4) << 30;

}  // namespace

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
