// Generators other than grid_of_holes.

#include "core/scene/plugins.h"
#include "tests/experiments/scenes/generated.h"

using namespace ulam;

TEST_CASE("every generator makes a scene with its defaults") {
    const auto generators = scenePlugins(PluginKind::Generators);
    CHECK(generators.size() >= 5);
    for (const PluginInfo& generator : generators) {
        INFO(generator.name);
        const SceneDescription description = describeGenerator({{"type", generator.name}});
        const Scene scene = description.build();
        CHECK(scene.warnings.empty());
        CHECK(scene.filter.type() == ReconstructionFilter::Type::Box);
        CHECK(description.dictionary()["type"] == "scene");
        CHECK(scene.hash == description.build().hash);
        for (const ParameterInfo& parameter : generator.parameters) CHECK_FALSE(parameter.help.empty());
    }
}

TEST_CASE("furnace: emission and reflections add up to 1") {
    for (const int depth : {1, 3, 8, 0}) {
        const SceneDescription description =
            describeGenerator({{"type", "furnace"}, {"reflectance", 0.6}, {"max_depth", depth}});
        const double emitted = description.dictionary()["sphere"]["emitter"]["radiance"];
        double radiance = 0;
        for (int k = 1; k <= (depth > 0 ? depth : 200); ++k) radiance += emitted * std::pow(0.6, k - 1);
        CHECK(radiance == Approx(1));
        CHECK(description.generator()->truth(square(2))->at(1, 1) == Rgb(1));
        const Scene scene = description.build();
        const Vec3f eye = scene.sensor->samplePosition({}).position;
        CHECK(length(eye) < 1);
        const Vertex seen = firstHit(scene, eye, scene.sensor->direction(scene.sensor->samplePosition({}), {3, 3}));
        CHECK(dot(seen.normal, seen.position) < 0);
    }
}

TEST_CASE("sphere_light_center: reflections of a point light's even light") {
    for (const int depth : {2, 5, 0}) {
        const SceneDescription description = describeGenerator(
            {{"type", "sphere_light_center"}, {"reflectance", 0.3}, {"intensity", 7}, {"max_depth", depth}});
        double radiance = 0;
        for (int k = 2; k <= (depth > 0 ? depth : 200); ++k) radiance += 7 / kPi * std::pow(0.3, k - 1);
        CHECK(description.generator()->truth(square(2))->at(0, 1).x == Approx(radiance));
    }
    CHECK(describeGenerator({{"type", "sphere_light_center"}}).generator()->truth(square(2))->at(0, 0).x ==
          Approx(0.5));
    CHECK(describeGenerator({{"type", "sphere_light_center"}, {"max_depth", 1}})
              .generator()
              ->truth(square(2))
              ->at(0, 0)
              .x == 0);
}

TEST_CASE("parallel_plates: the mean is Howell's form factor, the image agrees with brute force") {
    for (const double distance : {0.1, 1.0, 5.0})
        CHECK(meanOf(*describeGenerator({{"type", "parallel_plates"}, {"distance", distance}})
                          .generator()
                          ->truth(square(32))) == Approx(0.5).epsilon(1e-5));
    // Form factor of unit squares at distance 1: 0.19982 (tables of Howell's catalogue).
    const Image image = *describeGenerator({{"type", "parallel_plates"}, {"radiance", 1}, {"reflectance", 1}})
                             .generator()
                             ->truth(square(32));
    CHECK(meanOf(image) == Approx(0.19982).epsilon(1e-4));

    const SceneDescription description = describeGenerator({{"type", "parallel_plates"}, {"distance", 0.4}});
    const Json film = {{"width", 4}, {"height", 4}};
    const Scene scene = description.build(film);
    const Image truth = *description.generator()->truth(description.filmSize(film));
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) {
            const Estimate e = directLight(scene, Vec2f(float(x), float(y)), Vec2f(float(x + 1), float(y + 1)),
                                           "emitter", 20000, uint32_t(4 * y + x));
            CHECK(std::abs(e.mean - truth.at(x, y).x) <= 5 * e.error);
        }
    CHECK_FALSE(description.generator()->truth({64, 32, 0, 0, 64, 32}));
}

TEST_CASE("cornell_box: every wall and block faces the room") {
    for (const char* variant : {"plain", "glass_and_mirror", "glass_sphere", "glossy"}) {
        const Scene scene = describeGenerator({{"type", "cornell_box"}, {"variant", variant}}).build();
        Random random({41, 42}, 0, 0);
        for (int i = 0; i < 2000; ++i) {
            // From the upper part of the room, where it is empty; the front is open.
            const Vec3f origin(float(50 + 450 * random()), float(350 + 150 * random()), float(50 + 450 * random()));
            const Vec3f direction = squareToSphere(random(), random());
            Hit hit{};
            if (!scene.rays().intersect(origin, direction, hit)) {
                REQUIRE(direction.z < 0);
                continue;
            }
            Vertex v;
            scene.vertexAt(origin, direction, hit, v);
            INFO(variant << " " << scene.shapes[v.shape].id);
            REQUIRE(dot(v.normal, direction) < 0);
        }
        const Vec3f eye = scene.sensor->samplePosition({}).position;
        CHECK(scene.shapes[firstHit(scene, eye, scene.sensor->direction(scene.sensor->samplePosition({}), {10, 128})).shape].id == "red_wall");
        CHECK(scene.shapes[firstHit(scene, eye, scene.sensor->direction(scene.sensor->samplePosition({}), {246, 128})).shape].id == "green_wall");
    }
}
