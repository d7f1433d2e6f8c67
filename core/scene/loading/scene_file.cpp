#include "core/scene/loading/scene_file.h"

#include <algorithm>
#include <vector>

#include "core/base/error.h"
#include "core/config/suggest.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

/// With links followed.
std::vector<fs::path>& allowedFolders() {
    static std::vector<fs::path> folders;
    return folders;
}

bool isBelow(const fs::path& file, const fs::path& folder) {
    const fs::path inside = file.lexically_relative(folder);
    return !inside.empty() && *inside.begin() != "..";
}

}  // namespace

void allowFilesFrom(const fs::path& folder) {
    std::error_code failed;
    const fs::path real = fs::canonical(folder, failed);
    if (failed || !fs::is_directory(real, failed)) fail(ExitCode::InputMissing, "there is no folder {} for scenes' files", inQuotes(folder.string()));
    allowedFolders().push_back(real);
}

SceneFile findSceneFile(const fs::path& folder, const std::string& name) {
    const fs::path path = name;
    SceneFile result{folder / path, "", ""};
    const auto refused = [&](std::string refusal, std::string hint = {}) {
        result.refusal = std::move(refusal), result.hint = std::move(hint);
        return result;
    };
    if (name.empty()) return refused("the name of the file is empty");
    // The system would take it for the end of the name.
    if (name.find('\0') != name.npos) return refused("the name of the file holds a zero byte");
    std::error_code failed;
    if (!fs::exists(result.path, failed))
        for (const fs::path& other : allowedFolders())
            if (fs::exists(other / path, failed)) {
                result.path = other / path;
                break;
            }
    // Links may lead out of the folders too.
    const fs::path real = fs::weakly_canonical(result.path, failed);
    if (failed) return refused(fmt::format("the file cannot be found: {}", failed.message()));
    const fs::path own = fs::weakly_canonical(folder / ".", failed);
    const auto& others = allowedFolders();
    const auto holds = [&](const fs::path& allowed) { return isBelow(real, allowed); };
    if (failed || (!holds(own) && std::none_of(others.begin(), others.end(), holds)))
        return refused("the path leaves the folder of the scene",
                       "give a file below that folder, links followed, or allow another with --resource-path DIR");
    // Pipes and devices need not end.
    if (fs::exists(real, failed) && !fs::is_regular_file(real, failed)) return refused(fmt::format("{} is no regular file", printable(result.path.string(), 200)));
    return result;
}

}  // namespace ulam
