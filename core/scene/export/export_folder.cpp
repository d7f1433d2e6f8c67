#include "core/scene/export/export_folder.h"

#include <fcntl.h>
#include <stdio.h>

#include <cerrno>

#include "core/base/error.h"
#include "core/base/file.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void failToWrite(const fs::path& path, const std::error_code& error) {
    fail(ExitCode::CannotWrite, "cannot write {}: {}", path.string(), error.message());
}

void makeFolder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) failToWrite(folder, error);
}

/// Fails where a folder holds what no export wrote.
void checkReplaceable(const fs::path& folder, const ExportFormat& format) {
    const fs::path scene = folder / format.sceneFile;
    const std::string text = fs::is_regular_file(scene) ? readFile(scene) : "";
    const bool isExport = text.find(format.mark) != std::string::npos;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = entry.path().lexically_relative(folder).generic_string();
        const bool known = fs::is_directory(entry.symlink_status()) || name == format.sceneFile ||
                           text.find(fmt::format("\"{}\"", name)) != std::string::npos;
        if (!isExport || !known)
            fail(ExitCode::CannotWrite, "{} holds {}, which no earlier export wrote; name an empty or a new folder",
                 folder.string(), name);
    }
}

}  // namespace

ExportFolder::ExportFolder(const fs::path& place, const ExportFormat& format) : format_(format) {
    std::error_code error;
    place_ = fs::weakly_canonical(fs::absolute(place), error);
    if (error) failToWrite(place, error);
    if (!place_.has_filename()) place_ = place_.parent_path();
    if (fs::exists(place_)) {
        if (!fs::is_directory(place_)) failToWrite(place, std::make_error_code(std::errc::not_a_directory));
        checkReplaceable(place_, format_);
    }
    removeTemporaries(place_.parent_path(), Below::No);
    makeFolder(place_.parent_path());
    made_ = place_.parent_path() / temporaryName();
    fs::create_directory(made_, error);
    if (error) failToWrite(place_, error);
}

ExportFolder::~ExportFolder() {
    std::error_code ignored;
    fs::remove_all(made_, ignored);
}

void ExportFolder::write(const std::string& name, std::string_view bytes) {
    try {
        writeFileAtomically(pathFor(name), bytes);
    } catch (const Error& error) {  // which names the temporary folder
        fail(error.code(), "cannot write {}: {}", (place_ / name).string(), error.what());
    }
}

fs::path ExportFolder::pathFor(const std::string& name) const {
    makeFolder((made_ / name).parent_path());
    return made_ / name;
}

void ExportFolder::commit() {
    std::error_code error;
    const bool replaces = fs::exists(place_);
    // In one step, whenever the process is killed; the former export is thrown away under the temporary name.
    if (replaces && ::renameat2(AT_FDCWD, made_.c_str(), AT_FDCWD, place_.c_str(), RENAME_EXCHANGE) == 0) return;
    if (replaces && errno != EINVAL && errno != ENOSYS) failToWrite(place_, {errno, std::generic_category()});
    // Not every file system can.
    const fs::path former = place_.parent_path() / temporaryName();
    if (replaces) fs::rename(place_, former, error);
    if (error) failToWrite(place_, error);
    fs::rename(made_, place_, error);
    if (error) {
        std::error_code ignored;
        if (replaces) fs::rename(former, place_, ignored);
        failToWrite(place_, error);
    }
    fs::remove_all(former, error);
}

}  // namespace ulam
