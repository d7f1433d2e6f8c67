// The hard-scene library as a whole: every knob has the range that it is documented with.

#include "core/scene/plugins.h"
#include "tests/experiments/scenes/hard_scene.h"

using namespace ulam;

namespace {

struct Knob {
    const char* name;
    double min, max;
};
struct HardScene {
    const char* generator;
    std::vector<Knob> knobs;
};

/// The ranges that docs/hard-scenes.md gives.
const std::vector<HardScene> kHardScenes{
    {"door_ajar", {{"angle", 0.5, 90}, {"floor_alpha", 1e-4, 1}, {"lamp_size", 0.01, 1}, {"objects", 0, 12}}},
    {"mis_plates", {{"roughness", 0.02, 10}, {"light_size", 0.01, 2}}},
    {"keyhole", {{"hole_size", 0.02, 4}, {"holes", 1, 16}, {"lamp_offset", 0, 0.85}}},
    {"torus_in_glass", {{"alpha", 0, 0.5}, {"light_width", 0.25, 5}}},
    {"ring",
     {{"radius", 0.01, 100},
      {"height", 0.05, 2},
      {"alpha", 0, 0.5},
      {"light_angle", 10, 80},
      {"light_width", 0.05, 20}}},
    {"pool", {{"waves", 1, 64}, {"amplitude", 0, 0.12}, {"wavelength", 0.2, 2}, {"light_radius", 1e-4, 0.5}}},
    {"egg_room", {{"alpha", 0, 0.5}, {"ior", 1.05, 2.5}, {"walls", 0, 0.95}}},
    {"mirror_caustic_room", {{"share", 1e-5, 1}, {"walls", 0, 0.95}}},
    {"cornell_box", {{"alpha", 0.005, 0.3}}},
    {"necklace", {{"beads", 8, 2000}, {"alpha", 0, 0.5}, {"light_width", 0.1, 20}}},
};

}  // namespace

TEST_CASE("hard scenes: knobs have the documented ranges, both ends make scenes, values beyond are refused by name") {
    // What a scene may grow to: pool has 340² squares of water at its finest, necklace 2000 beads.
    constexpr size_t kMostTriangles = 250'000, kMostShapes = 2'010;
    const auto generators = scenePlugins(PluginKind::Generators);
    for (const HardScene& hardScene : kHardScenes) {
        const auto info = std::find_if(generators.begin(), generators.end(),
                                       [&](const PluginInfo& g) { return g.name == hardScene.generator; });
        REQUIRE(info != generators.end());
        for (const Knob& knob : hardScene.knobs) {
            const auto described = std::find_if(info->parameters.begin(), info->parameters.end(),
                                                [&](const ParameterInfo& p) { return p.name == knob.name; });
            INFO(hardScene.generator << " " << knob.name);
            REQUIRE(described != info->parameters.end());
            CHECK(described->min == knob.min);
            CHECK(described->max == knob.max);
            for (const double value : {knob.min, knob.max}) {
                INFO(value);
                const Scene scene = sceneOf(hardScene.generator, {{knob.name, value}});
                CHECK(scene.warnings.empty());
                CHECK(scene.shapes.size() <= kMostShapes);
                size_t triangles = 0;
                for (const Shape& shape : scene.shapes)
                    if (const Mesh* mesh = shape.triangleMesh()) triangles += mesh->triangles.size();
                CHECK(triangles <= kMostTriangles);
                CHECK(std::isfinite(scene.bounds().radius));
                CHECK(!scene.emitters.empty());
            }
            const double step = described->type == "integer" ? 1 : 1e-3 * (knob.max - knob.min);
            for (const double value : {knob.min - step, knob.max + step})
                CHECK_THROWS_WITH(sceneOf(hardScene.generator, {{knob.name, value}}),
                                  Catch::Contains(std::string("\"") + knob.name + "\""));
        }
        // Every number with two ends is in the table above; `seed` chooses, and makes nothing harder.
        for (const ParameterInfo& parameter : info->parameters)
            if (parameter.min && parameter.max && parameter.name != "seed")
                CHECK(std::any_of(hardScene.knobs.begin(), hardScene.knobs.end(),
                                  [&](const Knob& k) { return k.name == parameter.name; }));
    }
    CHECK_THROWS_WITH(sceneOf("door_ajar", {{"floor", "wood"}}), Catch::Contains("\"floor\""));
    CHECK_THROWS_WITH(sceneOf("keyhole", {{"radiance", -1}}), Catch::Contains("\"radiance\""));
    CHECK_THROWS_WITH(sceneOf("pool", {{"seed", -1}}), Catch::Contains("\"seed\""));
}
