#pragma once
// The folder of an exported scene: made beside its place, put there when it is complete.

#include <filesystem>
#include <string>
#include <string_view>

namespace ulam {

/// What an exporter writes.
struct ExportFormat {
    const char* sceneFile;  ///< holds the scene; all other files are named in it
    const char* mark;       ///< stands in that file and tells an export from other people's scenes
};

class ExportFolder {
public:
    /// Fails with CannotWrite where there is anything at `place` but an empty folder or an earlier export of this
    /// format and nothing else: nobody's files are lost.
    ExportFolder(const std::filesystem::path& place, const ExportFormat& format);
    /// Removes what was not put in its place.
    ~ExportFolder();
    ExportFolder(const ExportFolder&) = delete;
    ExportFolder& operator=(const ExportFolder&) = delete;

    /// `name` may begin with a folder: "meshes/wall.ply".
    void write(const std::string& name, std::string_view bytes);
    /// Where to write such a file oneself.
    std::filesystem::path pathFor(const std::string& name) const;
    void writeScene(std::string_view bytes) { write(format_.sceneFile, bytes); }
    /// Puts the folder in its place, that of an earlier export included.
    void commit();

private:
    ExportFormat format_;
    std::filesystem::path place_, made_;
};

}  // namespace ulam
