// ulam scene: what is in a scene; the scene in another renderer's language.

#include <array>
#include <chrono>

#include "core/base/error.h"
#include "core/config/suggest.h"
#include "core/scene/export/mitsuba.h"
#include "core/scene/export/pbrt4.h"
#include "experiments/cli/arguments.h"
#include "experiments/cli/commands.h"

namespace ulam {
namespace {

struct SceneArguments {
    std::string scene;
    std::vector<std::string> assignments, target;
    bool info = false, json = false;
    std::shared_ptr<SceneFileOptions> xml;
};

struct Exporter {
    const char* format;
    const char* sceneFile;
    std::vector<std::string> (*write)(const SceneDescription&, const std::filesystem::path&);
};
constexpr std::array kExporters{Exporter{"mitsuba3", "scene.xml", exportMitsuba3}, Exporter{"mitsuba06", "scene.xml", exportMitsuba06},
                                Exporter{"pbrt4", "scene.pbrt", exportPbrt4}};

void exportScene(const SceneDescription& description, const std::string& format, const std::string& folder) {
    std::vector<std::string> formats;
    for (const Exporter& exporter : kExporters) {
        formats.emplace_back(exporter.format);
        if (format != exporter.format) continue;
        for (const std::string& leftOut : exporter.write(description, folder)) fmt::print(stderr, "left out: {}\n", leftOut);
        fmt::print("{}\n", (std::filesystem::path(folder) / exporter.sceneFile).string());
        return;
    }
    fail(ExitCode::Usage, "expected --export FORMAT DIR with a format of {}, found {}", listInQuotes(formats), inQuotes(format));
}

void printScene(const SceneDescription& description, const SceneArguments& a) {
    const Scene scene = description.build();
    std::size_t triangles = 0, instances = 0;
    for (const Shape& shape : scene.shapes) {
        if (const Mesh* mesh = shape.triangleMesh()) triangles += mesh->triangles.size();
        instances += std::holds_alternative<MeshInstance>(shape.geometry);
    }
    const BoundingSphere& bounds = scene.bounds();
    const MemoryNeeds memory = scene.memory(Scene::Tree::Building);
    if (a.json) {
        fmt::print("{}\n",
                   dump({{"schema_version", 1},
                         {"hash", scene.hash},
                         {"width", scene.sensor->width()},
                         {"height", scene.sensor->height()},
                         {"shapes", scene.shapes.size()},
                         {"mesh_instances", instances},
                         {"triangles", triangles},
                         {"materials", scene.materials.size()},
                         {"emitters", scene.emitters.size()},
                         {"estimated_memory_bytes", std::uint64_t(totalBytes(memory))},
                         {"bounds",
                          {{"center", {bounds.center.x, bounds.center.y, bounds.center.z}}, {"radius", bounds.radius}}},
                         {"features", scene.features.names},
                         {"feature_grid", {scene.features.rows, scene.features.columns}},
                         {"warnings", scene.warnings},
                         {"dictionary", description.dictionary()}}));
        return;
    }
    fmt::print("image      {} x {}\nshapes     {} ({} of them meshes of instances; {} triangles)\nmaterials  {}\nemitters   {}\n",
               scene.sensor->width(), scene.sensor->height(), scene.shapes.size(), instances, triangles, scene.materials.size(),
               scene.emitters.size());
    fmt::print("bounds     center {:.6g} {:.6g} {:.6g}, radius {:.6g}\n", bounds.center.x, bounds.center.y,
               bounds.center.z, bounds.radius);
    if (!scene.features.empty())
        fmt::print("features   {} ({} x {}), {} … {}\n", scene.features.names.size(), scene.features.rows,
                   scene.features.columns, scene.features.names.front(), scene.features.names.back());
    fmt::print("memory     about {}\n", sizeText(totalBytes(memory)));
    for (const MemoryNeed& need : memory)
        if (need.bytes > 0) fmt::print("           {} for {}\n", sizeText(need.bytes), need.what);
    fmt::print("hash       {}\n", scene.hash);
    for (const std::string& warning : scene.warnings) fmt::print("warning    {}\n", warning);
}

void runScene(const SceneArguments& a) {
    if (a.info == !a.target.empty())
        fail(ExitCode::Usage, "expected ulam scene SCENE --info, or ulam scene SCENE --export FORMAT DIR");
    auto [document, folder, file] = sceneArgument(a.scene, *a.xml);
    document.applyOverrides(a.assignments);
    const SceneDescription description = SceneDescription::fromNode(document.root(), folder);
    if (a.info)
        printScene(description, a);
    else
        exportScene(description, a.target[0], a.target[1]);
}

}  // namespace

void addSceneCommand(CLI::App& app) {
    auto a = std::make_shared<SceneArguments>();
    CLI::App& command = *app.add_subcommand("scene", "what is in a scene; write it for another renderer");
    command.add_option("scene", a->scene, "JSON, XML or pbrt file, generator (see: ulam list generators), or JSON")->required();
    a->xml = addSceneFileOptions(command);
    addResourceOption(command);
    command.add_option("--set", a->assignments, "KEY=VALUE in the scene's dictionary (repeatable)")
        ->type_name("PATH=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    command.add_flag("--info", a->info, "count what is in it");
    command.add_flag("--json", a->json, "as JSON, with the expanded dictionary");
    command.add_option("--export", a->target, "write the scene for Mitsuba 3, Mitsuba 0.6 or pbrt-v4 into a folder")
        ->type_name("mitsuba3|mitsuba06|pbrt4 DIR")
        ->expected(2);
    command.callback([a] { runScene(*a); });
}

}  // namespace ulam
