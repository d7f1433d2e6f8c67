#pragma once
// The folder of an exported scene: made beside its place, put there when it is complete.

#include <filesystem>
#include <string>
#include <string_view>

namespace ulam {

class ExportFolder {
public:
    /// Fails with CannotWrite where there is anything at `place` but an empty folder or an earlier export and nothing
    /// else: nobody's files are lost.
    explicit ExportFolder(const std::filesystem::path& place);
    /// Removes what was not put in its place.
    ~ExportFolder();
    ExportFolder(const ExportFolder&) = delete;
    ExportFolder& operator=(const ExportFolder&) = delete;

    /// `name` may begin with a folder: "meshes/wall.ply".
    void write(const std::string& name, std::string_view bytes);
    /// Puts the folder in its place, that of an earlier export included.
    void commit();

    /// The file that holds the scene; all others are named in it.
    static constexpr const char* sceneFile = "scene.xml";
    /// Stands in that file and tells an export from other people's scenes.
    static constexpr const char* mark = " Written by Ulam for Mitsuba 3 ";

private:
    std::filesystem::path place_, made_;
};

}  // namespace ulam
