#include "core/scene/export/assets.h"

#include <fmt/format.h>

#include "core/image/image_io.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/textures.h"
#include "core/scene/mesh_io.h"
#include "core/scene/octahedral_map.h"

namespace ulam {
namespace {

std::string plain(std::string text) {
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = '_';
    return text;
}

}  // namespace

std::string UniqueNames::make(const std::string& name, const std::string& ending) {
    // Mitsuba keeps ids that begin with "_" to itself.
    std::string stem = plain(name);
    if (stem.empty() || stem[0] == '_') stem.insert(0, 1, 'x');
    std::string unique = stem + ending;
    for (int i = 2; !taken_.insert(unique).second; ++i) unique = fmt::format("{}_{}{}", stem, i, ending);
    return unique;
}

std::string UniqueNames::makeFile(const std::filesystem::path& file) {
    const std::string ending = file.extension().string();
    return make((file.parent_path() / file.stem()).string(),
                ending.empty() ? "" : fmt::format(".{}", plain(ending.substr(1))));
}

std::string ExportAssets::copy(const JsonNode& filename, const std::string& subfolder) {
    const auto [copy, isNew] = copies_.try_emplace(filename.string());
    if (isNew) {
        copy->second = fmt::format("{}/{}", subfolder, names_.makeFile(filename.string()));
        folder_.write(copy->second, files.read(filename));
    }
    return copy->second;
}

std::string ExportAssets::mesh(const Mesh& mesh, const std::string& name) {
    const std::string file = fmt::format("meshes/{}", names_.make(name, ".ply"));
    folder_.write(file, plyBytes(mesh));
    return file;
}

std::string ExportAssets::image(const Image& image, const std::string& name) {
    const std::string file = fmt::format("textures/{}", names_.make(name, ".exr"));
    writeExr(folder_.pathFor(file).string(), image);
    return file;
}

std::optional<ExportAssets::Baked> ExportAssets::bakedPicture(const JsonNode& plugin) {
    const std::string& type = pluginName(plugin);
    Json rest = plugin.json();
    rest.erase("filename");
    if (type == "envmap" && plugin.find("mapping") && plugin.at("mapping").string() == "octahedral") {
        rest.erase("mapping");
        return Baked{rest, image(latLongFromOctahedral(files.readImage(plugin.at("filename"), false)), "environment")};
    }
    if (type != "bitmap" || !(plugin.find("scale") || plugin.find("invert"))) return {};
    const Image picture = readPicture(plugin, files);
    for (const char* name : {"scale", "invert", "raw"}) rest.erase(name);  // what is written is linear
    return Baked{rest, image(picture, "picture")};
}

}  // namespace ulam
