#include "core/path/tracing.h"

#include "core/base/warp.h"
#include "tests/support/catch.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

TEST_CASE("the direction of a ray is known from the vertices at its ends, however close they are") {
    const Scene scene = buildScene(pathScene("glass_and_mirror").dictionary);
    Tracing tracing(scene);
    int met = 0, close = 0;
    double worst = 0, worstBetweenPlaces = 0;
    for (uint64_t i = 0; i < 200'000; ++i) {
        Random random(makeKey(3), 0, i);
        const Vec3f w = squareToSphere(random(), random());
        Vertex from, to;
        if (!tracing.nextFrom(scene.sensor->position(), w, from) || !from.onSurface()) continue;
        // Close to where this one ended: half of the rays leave along the surface.
        const Vec3f along = squareToSphere(random(), random());
        const Vec3f direction =
            random() < 0.5 ? along : normalize(along - from.normal * (dot(along, from.normal) * 0.9f));
        if (!tracing.next(from, direction, to) || !to.onSurface()) continue;
        const double way = length(to.position - from.position);
        if (way < 0.02 * double(scene.bounds().radius)) ++close;
        ++met;
        // What single-precision places allow on this way.
        const double rounding = 4e-7 * scene.bounds().radius / way + 1e-6;
        worst = std::max(worst, double(length(tracing.directionOfRay(from, to) - direction)) / rounding);
        worstBetweenPlaces = std::max(worstBetweenPlaces, double(length(directionTo(from, to) - direction)) / rounding);
    }
    CHECK(met > 10'000);
    CHECK(close > 100);
    CHECK(worst < 1);
    // So the test can fail: places alone do not tell.
    CHECK(worstBetweenPlaces > 3);
}

TEST_CASE("what is close to the camera hides what is far, also when light looks for the camera") {
    // A plate of 2 mm, 5 mm before the pinhole, and a wall at 20 km, whose places are known to 2 mm.
    const Json plate = {
        {"type", "rectangle"},
        {"to_world", {{{"type", "scale"}, {"value", 0.001}}, {{"type", "translate"}, {"value", {0, 0, -0.005}}}}}};
    const Json wall = {
        {"type", "rectangle"},
        {"to_world", {{{"type", "scale"}, {"value", 5000}}, {{"type", "translate"}, {"value", {0, 0, -20'000}}}}}};
    const Scene scene = buildScene({{"type", "scene"},
                                    {"plate", plate},
                                    {"wall", wall},
                                    {"sky", {{"type", "constant"}}},
                                    {"sensor",
                                     {{"type", "perspective"},
                                      {"fov", 40},
                                      {"to_world", {{{"type", "rotate"}, {"axis", {0, 1, 0}}, {"angle", 180}}}}}}});
    Tracing tracing(scene);
    Vertex camera{};
    camera.kind = Vertex::Kind::Point;
    camera.position = scene.sensor->position();
    int hidden = 0, seen = 0;
    for (uint64_t i = 0; i < 10'000; ++i) {
        Random random(makeKey(5), 0, i);
        const double x = 0.0012 * (2 * random() - 1), y = 0.0012 * (2 * random() - 1);
        const bool inside = std::max(std::abs(x), std::abs(y)) < 0.001;
        Vertex behind;
        // Where the line from the camera meets the wall, found from beyond the plate.
        REQUIRE(tracing.nextFrom(Vec3f(float(2 * x), float(2 * y), -0.01f),
                                 normalize(Vec3f(float(x), float(y), -0.005f)), behind));
        REQUIRE(behind.position.z < -19'000);
        ++(inside ? hidden : seen);
        CHECK(tracing.visible(behind, camera) == !inside);
        CHECK(tracing.visible(camera, behind) == !inside);
    }
    CHECK(hidden > 5000);
    CHECK(seen > 1000);
}
