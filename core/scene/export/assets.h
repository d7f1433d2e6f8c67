#pragma once
// The files of an exported scene, and names for what is in it.

#include <map>
#include <set>

#include "core/scene/export/export_folder.h"
#include "core/scene/loading/context.h"
#include "core/scene/shape.h"

namespace ulam {

/// Names of letters, digits, "_" and "-", never the same twice.
class UniqueNames {
public:
    std::string make(const std::string& name, const std::string& ending = "");
    /// The name of a copy of a file, with its ending.
    std::string makeFile(const std::filesystem::path& file);

private:
    std::set<std::string> taken_;
};

class ExportAssets {
public:
    /// `scene`: the folder that the scene's files are in.
    ExportAssets(ExportFolder& folder, const std::filesystem::path& scene) : folder_(folder) { files.folder = scene; }

    /// All of these return the name of the file that is written, from the export's folder. A file is copied once.
    std::string copy(const JsonNode& filename, const std::string& subfolder);
    std::string mesh(const Mesh& mesh, const std::string& name);
    std::string image(const Image& image, const std::string& name);
    /// An `envmap` or `bitmap` with parameters that only Ulam has, as a picture without them; nothing for other
    /// plugins. `plugin`: the dictionary without these and without its filename.
    struct Baked {
        Json plugin;
        std::string file;
    };
    std::optional<Baked> bakedPicture(const JsonNode& plugin);

    LoadContext files;

private:
    ExportFolder& folder_;
    UniqueNames names_;
    std::map<std::string, std::string> copies_;  ///< by file name in the scene
};

}  // namespace ulam
