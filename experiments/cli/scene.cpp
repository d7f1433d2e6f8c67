// ulam scene: what is in a scene.

#include <chrono>

#include "core/base/error.h"
#include "experiments/cli/arguments.h"
#include "experiments/cli/commands.h"

namespace ulam {
namespace {

struct SceneArguments {
    std::string scene;
    std::vector<std::string> assignments;
    bool info = false, json = false;
};

void printScene(const SceneArguments& a) {
    if (!a.info) fail(ExitCode::Usage, "expected ulam scene SCENE --info");
    auto [document, folder] = sceneArgument(a.scene);
    document.applyOverrides(a.assignments);
    const SceneDescription description = SceneDescription::fromNode(document.root(), folder);
    const Scene scene = description.build();
    std::size_t triangles = 0;
    for (const Shape& shape : scene.shapes)
        if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry)) triangles += mesh->triangles.size();
    const BoundingSphere& bounds = scene.bounds();
    if (a.json) {
        fmt::print("{}\n",
                   dump({{"schema_version", 1},
                         {"hash", scene.hash},
                         {"width", scene.sensor->width()},
                         {"height", scene.sensor->height()},
                         {"shapes", scene.shapes.size()},
                         {"triangles", triangles},
                         {"materials", scene.materials.size()},
                         {"emitters", scene.emitters.size()},
                         {"bounds",
                          {{"center", {bounds.center.x, bounds.center.y, bounds.center.z}}, {"radius", bounds.radius}}},
                         {"features", scene.features.names},
                         {"feature_grid", {scene.features.rows, scene.features.columns}},
                         {"warnings", scene.warnings},
                         {"dictionary", description.dictionary()}}));
        return;
    }
    fmt::print("image      {} x {}\nshapes     {} ({} triangles)\nmaterials  {}\nemitters   {}\n",
               scene.sensor->width(), scene.sensor->height(), scene.shapes.size(), triangles, scene.materials.size(),
               scene.emitters.size());
    fmt::print("bounds     center {:.6g} {:.6g} {:.6g}, radius {:.6g}\n", bounds.center.x, bounds.center.y,
               bounds.center.z, bounds.radius);
    if (!scene.features.empty())
        fmt::print("features   {} ({} x {}), {} … {}\n", scene.features.names.size(), scene.features.rows,
                   scene.features.columns, scene.features.names.front(), scene.features.names.back());
    fmt::print("hash       {}\n", scene.hash);
    for (const std::string& warning : scene.warnings) fmt::print("warning    {}\n", warning);
}

}  // namespace

void addSceneCommand(CLI::App& app) {
    auto a = std::make_shared<SceneArguments>();
    CLI::App& command = *app.add_subcommand("scene", "what is in a scene");
    command.add_option("scene", a->scene, "JSON file, generator (see: ulam list generators), or JSON")->required();
    command.add_option("--set", a->assignments, "KEY=VALUE in the scene's dictionary (repeatable)")
        ->type_name("PATH=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    command.add_flag("--info", a->info, "count what is in it");
    command.add_flag("--json", a->json, "as JSON, with the expanded dictionary");
    command.callback([a] { printScene(*a); });
}

}  // namespace ulam
