// Splats that wait arrive: the same image as without waiting.

#include "core/image/splat_queue.h"

#include "core/base/random.h"
#include "tests/support/catch.h"

using namespace ulam;

TEST_CASE("splats that went through a queue make the same image") {
    for (const int count : {0, 1, 7, 8, 9, 1000}) {
        Film direct(20, 10, ReconstructionFilter()), film(20, 10, ReconstructionFilter());
        SplatQueue queue(film);
        Random random(makeKey(3), 0, 0);
        for (int i = 0; i < count; ++i) {
            // Some of them beside the film.
            const Vec2f raster(float(24 * random() - 2), float(14 * random() - 2));
            const Spectrum value(random(), random(), random());
            direct.splat(raster, value);
            queue.add(raster, value);
            if (i == 500) queue.flush();
        }
        queue.flush();
        queue.flush();  // nothing twice
        REQUIRE(film.develop(1).pixels == direct.develop(1).pixels);
    }
}
