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
        const Vec3f direction = random() < 0.5 ? along : normalize(along - from.normal * (dot(along, from.normal) * 0.9f));
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
