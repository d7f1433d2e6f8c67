// Emitters, sensor and filters: samples against densities, and their inverses.

#include "core/path/densities.h"
#include "core/render/independent_run.h"
#include "tests/support/chi_square.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

namespace {

/// The scene with every kind of light, and the index of the emitter that belongs to a shape or is of a type.
struct Lights {
    explicit Lights(const std::string& name = "many_lights") : scene(buildScene(pathScene(name).dictionary)) {}

    Scene scene;

    uint32_t of(const std::string& shape) const {
        for (const Shape& s : scene.shapes)
            if (s.id == shape) return s.emitter;
        FAIL("no shape " << shape);
        return kNone;
    }
    template <class T>
    uint32_t ofType() const {
        for (uint32_t i = 0; i < scene.emitters.size(); ++i)
            if (std::holds_alternative<T>(scene.emitters[i])) return i;
        FAIL("no such emitter");
        return kNone;
    }
    const AreaEmitter& area(const std::string& shape) const { return std::get<AreaEmitter>(scene.emitters[of(shape)]); }
};

std::vector<uint32_t> allEmitters(const Scene& scene) {
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < scene.emitters.size(); ++i) indices.push_back(i);
    return indices;
}

}  // namespace

TEST_CASE("positions on area lights follow their density") {
    const Lights lights;
    const EmissionContext c = lights.scene.emission(0);
    SECTION("rectangle") {
        const AreaEmitter& lamp = lights.area("lamp");
        // 0.8 × 0.8 at y = 1.95, centre (0.2, 0.3).
        CHECK_FIT(misfit(
            {-0.2, 0.6, -0.1, 0.7, 20, 20},
            [&](Random& r) {
                const Vertex v = lamp.samplePosition(c, r.nextBlock());
                return Sample2{v.position.x, v.position.z};
            },
            [&](double, double) { return lamp.positionPdf(c, Vertex{}); }, 1));
    }
    SECTION("sphere") {
        const AreaEmitter& glow = lights.area("glow");
        CHECK_FIT(misfit(
            kDirections,
            [&](Random& r) {
                const Vertex v = glow.samplePosition(c, r.nextBlock());
                REQUIRE(length(v.normal - (v.position - Vec3f(-0.7f, 0.3f, 0.4f)) / 0.2f) < 1e-5f);
                return azimuthAndZ(v.normal);
            },
            [&](double, double) { return glow.positionPdf(c, Vertex{}) * 0.2 * 0.2; }, 2));
    }
    SECTION("triangle mesh") {
        const AreaEmitter& crystal = lights.area("crystal");
        const Shape& shape = lights.scene.shapes[crystal.shape];
        const Mesh& mesh = std::get<Mesh>(shape.geometry);
        // Over all triangles at once: (triangle + first coordinate, second).
        const auto triangles = double(mesh.triangles.size());
        CHECK_FIT(misfit(
            {0, triangles, 0, 1, int(triangles) * 10, 10},
            [&](Random& r) {
                const Vertex v = crystal.samplePosition(c, r.nextBlock());
                return Sample2{v.primitive + double(v.uv.x), v.uv.y};
            },
            [&](double x, double y) {
                const double u = x - std::floor(x), sum = u + y;
                const auto& t = mesh.triangles[std::min(size_t(x), mesh.triangles.size() - 1)];
                const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), d(mesh.positions[t[2]]);
                const double jacobian = (b - a).cross(d - a).length();
                return crystal.positionPdf(c, Vertex{}) * jacobian * (std::abs(sum - 1) < 1e-9 ? 0.5 : sum < 1 ? 1 : 0);
            },
            3));
    }
}

TEST_CASE("directions of light follow their density") {
    const Lights lights;
    Random random(makeKey(4), 0, 0);
    for (const uint32_t e : allEmitters(lights.scene)) {
        const EmissionContext c = lights.scene.emission(e);
        INFO("emitter " << e);
        dispatch(lights.scene.emitters[e], [&](const auto& emitter) {
            const Vertex x0 = emitter.samplePosition(c, random.nextBlock());
            if (x0.kind == Vertex::Kind::Infinite) return;  // below
            CHECK_FIT(misfit(
                kDirections,
                [&](Random& r) {
                    const EmittedRay ray = emitter.sampleDirection(c, x0, r.nextBlock());
                    REQUIRE(ray.pdf == Approx(emitter.directionPdf(c, x0, ray.direction)).epsilon(1e-4).margin(1e-6));
                    REQUIRE(ray.origin == x0.position);
                    return azimuthAndZ(ray.direction);
                },
                [&](double phi, double z) { return emitter.directionPdf(c, x0, directionOf(phi, z)); },
                uint64_t(5 + e)));
        });
    }
}

TEST_CASE("the sky: directions are uniform, rays uniform over the scene's disc") {
    const Lights lights;
    const uint32_t e = lights.ofType<ConstantEmitter>();
    const auto& sky = std::get<ConstantEmitter>(lights.scene.emitters[e]);
    const EmissionContext c = lights.scene.emission(e);
    CHECK_FIT(misfit(
        kDirections, [&](Random& r) { return azimuthAndZ(sky.samplePosition(c, r.nextBlock()).position); },
        [&](double phi, double z) {
            Vertex x0{};
            x0.position = directionOf(phi, z);
            return sky.positionPdf(c, x0);
        },
        20));
    Vertex x0 = sky.samplePosition(c, Block{0, 0.2, 0.7, 0});
    const Frame frame(x0.position);
    const double r2 = double(c.bounds.radius) * c.bounds.radius;
    CHECK_FIT(misfit(
        {-kPi, kPi, 0, 1, 32, 16},
        [&](Random& r) {
            const EmittedRay ray = sky.sampleDirection(c, x0, r.nextBlock());
            REQUIRE(ray.direction == -x0.position);
            const Vec3f p = frame.toLocal(ray.origin - c.bounds.center);
            REQUIRE(p.z == Approx(c.bounds.radius).epsilon(1e-5));
            return Sample2{std::atan2(double(p.y), double(p.x)), (double(p.x) * p.x + double(p.y) * p.y) / r2};
        },
        [&](double, double) { return sky.directionPdf(c, x0, -x0.position) * r2 / 2; }, 21));
    // The disc covers the scene: every point of every shape.
    for (const Shape& shape : lights.scene.shapes)
        if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry))
            for (const Vec3f& p : mesh->positions) CHECK(length(p - c.bounds.center) <= c.bounds.radius);
}

TEST_CASE("next-event samples follow their density, emitters are chosen by their probabilities") {
    const Lights lights(GENERATE("many_lights", "thin_lens", "sun_and_sky", "clear_sky"));
    const Scene& scene = lights.scene;
    Vertex from{};
    from.kind = Vertex::Kind::Surface;
    from.position = {0.1f, 0, 0.2f};
    Random random(makeKey(30), 0, 0);
    Subpath light;
    std::vector<double> counts(scene.emitters.size(), 0), probabilities;
    for (uint32_t e = 0; e < counts.size(); ++e) probabilities.push_back(scene.emitterChoice().probability(e));
    for (int i = 0; i < 200'000; ++i) {
        sampleDirectLight(scene, from, random.nextBlock(), light);
        const Vertex& x0 = light.vertex[0];
        const uint32_t e = scene.emitterAt(x0);
        ++counts[e];
        REQUIRE(light.forward[0] == Approx(directLightPdf(scene, from, x0)));
        // The density is the choice's times the one of the emitter's own sampling, whose fit the other cases test.
        const double own = dispatch(scene.emitters[e],
                                    [&](const auto& emitter) { return emitter.positionPdf(scene.emission(e), x0); });
        REQUIRE(light.forward[0] == Approx(probabilities[e] * own));
    }
    CHECK_FIT(misfit(counts, probabilities));
}

TEST_CASE("emitters: the numbers of a position or direction give it again") {
    const Lights lights(GENERATE("many_lights", "thin_lens", "sun_and_sky", "clear_sky"));
    const Scene& scene = lights.scene;
    Random random(makeKey(31), 0, 0);
    Vertex from{};
    from.kind = Vertex::Kind::Surface;
    for (const uint32_t e : allEmitters(scene))
        dispatch(scene.emitters[e], [&](const auto& emitter) {
            INFO("emitter " << e);
            const EmissionContext c = scene.emission(e);
            for (int i = 0; i < 20'000; ++i) {
                const Vertex x0 = emitter.samplePosition(c, random.nextBlock());
                Block u = random.nextBlock();
                const double untouched[2] = {u[0], u[3]};
                emitter.invertPosition(c, x0, u);
                REQUIRE((u[0] == untouched[0] && u[3] == untouched[1]));
                const Vertex again = emitter.samplePosition(c, u);
                REQUIRE(length(again.position - x0.position) < 1e-5f);
                REQUIRE((again.shape == x0.shape && again.primitive == x0.primitive && again.kind == x0.kind));

                const Vertex direct = emitter.sampleDirect(c, from, random.nextBlock());
                emitter.invertDirect(c, direct, u);
                REQUIRE(length(emitter.sampleDirect(c, from, u).position - direct.position) < 1e-5f);

                const EmittedRay ray = emitter.sampleDirection(c, x0, random.nextBlock());
                Vertex x1{};
                x1.kind = Vertex::Kind::Surface;
                x1.position = ray.origin + ray.direction * 1.7f;
                u = random.nextBlock();
                emitter.invertDirection(c, x0, x1, u);
                const EmittedRay rayAgain = emitter.sampleDirection(c, x0, u);
                REQUIRE(length(rayAgain.direction - ray.direction) < 1e-5f);
                REQUIRE(length(rayAgain.origin - ray.origin) < 2e-5f);
            }
        });
}

TEST_CASE("the sensor's directions follow its importance, which is normalised, and give their raster again") {
    // 90° across, so that the film is [-1,1] wide on the plane z = 1; cropped and with an even margin for its filter.
    const char* text = R"({"type": "scene", "light": {"type": "point"}, "sensor": {"type": "perspective", "fov": 90,
        "film": {"type": "hdrfilm", "width": 40, "height": 20, "crop_offset_x": 10, "crop_offset_y": 5, "crop_width": 20, "crop_height": 10,
                 "rfilter": {"type": "tent", "radius": 2}}}})";
    const Scene scene = buildScene(Json::parse(text), Json::object());
    const Perspective& sensor = *scene.sensor;
    const Vertex eye = sensor.samplePosition({});
    const double pixel = 2.0 / 40, margin = (double(sensor.window().max.x) - sensor.width()) * pixel;
    const double x = 10 * pixel + margin, y = 5 * pixel + margin;
    CHECK(margin > 0);
    CHECK_FIT(misfit(
        {-x, x, -y, y, 24, 14},
        [&](Random& r) {
            const Vec3f w = sensor.direction(eye, sensor.sampleRaster(r.nextBlock()));
            return Sample2{double(w.x) / w.z, double(w.y) / w.z};
        },
        [&](double px, double py) {
            const double c = 1 / std::sqrt(1 + px * px + py * py);
            return sensor.respond(eye, Vec3f(float(px * c), float(py * c), float(c))).pdf * c * c * c;
        },
        40));
    Random random(makeKey(41), 0, 0);
    for (int i = 0; i < 100'000; ++i) {
        const Block u = random.nextBlock();
        const Vec2f raster = sensor.sampleRaster(u);
        const auto again = sensor.respond(eye, sensor.direction(eye, raster));
        // At the window's border rounding may put the direction outside.
        if (again.importance > 0)
            REQUIRE((again.raster - raster).length() < 1e-4f);
        else
            REQUIRE((std::abs(std::abs(raster.x - 10) - 12) < 1e-3f || std::abs(std::abs(raster.y - 5) - 7) < 1e-3f));
        Block v = random.nextBlock();
        sensor.invertRaster(raster, v);
        REQUIRE((sensor.sampleRaster(v) - raster).length() < 1e-5f);
    }
    CHECK(sensor.respond(eye, {0, 0, -1}).importance == 0);
}

TEST_CASE("a thin lens: its focal plane is sharp, its importance normalised, its numbers are found again") {
    const char* text = R"({"type": "scene", "light": {"type": "point"}, "sensor": {"type": "thinlens", "fov": 60, "aperture_radius": 0.25, "focus_distance": 4,
        "to_world": [{"type": "lookat", "origin": [1, 2, 3], "target": [0, 1, 7], "up": [0.1, 1, 0]}],
        "film": {"type": "hdrfilm", "width": 40, "height": 30, "rfilter": {"type": "box"}}}})";
    const Scene scene = buildScene(Json::parse(text), Json::object());
    const Perspective& sensor = *scene.sensor;
    Random random(makeKey(42), 0, 0);
    double norm = 0;
    constexpr int kSamples = 100'000;
    for (int i = 0; i < kSamples; ++i) {
        const Block u = random.nextBlock();
        const Vertex lens = sensor.samplePosition(u), other = sensor.samplePosition(random.nextBlock());
        REQUIRE(lens.kind == Vertex::Kind::Lens);
        REQUIRE(length(lens.position - sensor.position()) <= 0.25f + 1e-6f);
        Block found = random.nextBlock();
        sensor.invertPosition(lens, found);
        REQUIRE(length(sensor.samplePosition(found).position - lens.position) < 1e-5f);

        const Vec2f raster = sensor.sampleRaster(u);
        const Vec3f w = sensor.direction(lens, raster), v = sensor.direction(other, raster);
        const auto sharp = [&](const Vertex& x, const Vec3f& d) { return x.position + d * (4 / dot(d, sensor.axis())); };
        REQUIRE(length(sharp(lens, w) - sharp(other, v)) < 2e-5f);
        const auto response = sensor.respond(lens, w);
        if (!(response.importance > 0)) continue;  // rounded over the border
        REQUIRE((response.raster - raster).length() < 1e-3f);
        // ∫ W_e |cosθ| dω dA by its own samples.
        norm += response.importance * dot(w, sensor.axis()) / (response.pdf * sensor.positionPdf(lens) * kSamples);
    }
    CHECK(norm == Approx(1).epsilon(1e-4));
    // The density of directions, against the image plane at distance 1 seen from a point off the axis.
    const Vertex lens = sensor.lensPoint({0.6f, -0.5f});
    const Frame frame(sensor.axis());
    CHECK_FIT(misfit(
        {-0.9, 0.9, -0.9, 0.9, 24, 24},
        [&](Random& r) -> std::optional<Sample2> {
            const Vec3f w = frame.toLocal(sensor.direction(lens, sensor.sampleRaster(r.nextBlock())));
            return Sample2{double(w.x) / w.z, double(w.y) / w.z};
        },
        [&](double px, double py) {
            const double c = 1 / std::sqrt(1 + px * px + py * py);
            return sensor.respond(lens, frame.toWorld(Vec3f(float(px * c), float(py * c), float(c)))).pdf * c * c * c;
        },
        43));
}

TEST_CASE("spot: full intensity in the beam, a linear ramp, nothing outside; power and cone") {
    SpotEmitter::Parameters p;
    p.intensity = Spectrum(2, 4, 8), p.cutoffAngle = 40, p.beamWidth = 25;
    const SpotEmitter spot(p, {1, 2, 3}, normalize(Vec3f(1, -1, 0.5f)));
    const EmissionContext none{};
    const Vertex x0 = spot.samplePosition(none, {});
    const auto along = [&](double degrees) {
        const double t = degrees * kPi / 180;
        return spot.frame.toWorld({float(std::sin(t)), 0, float(std::cos(t))});
    };
    for (const auto& [degrees, share] : {std::pair(0.0, 1.0), {24.0, 1.0}, {30.0, 10.0 / 15}, {39.0, 1.0 / 15}, {41.0, 0.0}, {170.0, 0.0}}) {
        CHECK(spot.radiance(none, x0, along(degrees)).y == Approx(4 * share).margin(1e-5));
        CHECK((spot.directionPdf(none, x0, along(degrees)) > 0) == (share > 0));
    }
    double integral = 0;
    constexpr int kSteps = 200'000;
    for (int i = 0; i < kSteps; ++i) {
        const double degrees = 40 * (i + 0.5) / kSteps;
        integral += luminance(spot.radiance(none, x0, along(degrees))) * std::sin(degrees * kPi / 180) * 2 * kPi * (40 * kPi / 180 / kSteps);
    }
    CHECK(spot.power(none) == Approx(integral).epsilon(1e-5));
    CHECK_FIT(misfit(
        kDirections, [&](Random& r) { return azimuthAndZ(spot.sampleDirection(none, x0, r.nextBlock()).direction); },
        [&](double phi, double z) { return spot.directionPdf(none, x0, directionOf(phi, z)); }, 44));
}

TEST_CASE("an environment map: directions follow their density, which follows the radiance") {
    Image picture(6, 4);
    Random random(makeKey(45), 0, 0);
    for (Rgb& pixel : picture.pixels) pixel = Rgb(float(random() * random()), float(random()), 0.5f);
    picture.at(2, 1) = Rgb(30, 30, 20);
    const Axes axes{normalize(Vec3f(1, 0.2f, 0)), Vec3f(0, 0, 0), Vec3f(0, 0, 0)};
    const Frame frame(axes[0]);
    const EnvironmentMap map(picture, 0.5, {frame.s, frame.t, frame.n});
    CHECK_FIT(misfit(
        kDirections, [&](Random& r) { const double u = r(); return azimuthAndZ(map.sample(u, r())); },
        [&](double phi, double z) { return map.pdf(directionOf(phi, z)); }, 46));
    double integral = 0;
    Vec3f brightest;
    constexpr int kSamples = 200'000;
    for (int i = 0; i < kSamples; ++i) {
        const double u = random(), v = random();
        const Vec3f w = map.sample(u, v);
        const Sample2 again = map.invert(w, 0.5);
        REQUIRE(length(map.sample(again.u, again.v) - w) < 1e-5f);
        integral += luminance(map.radiance(w)) / map.pdf(w) / kSamples;
    }
    CHECK(map.totalLuminance() == Approx(integral).epsilon(0.01));
    // Row 1 of 4 is at 60° from +y, column 2 of 6 at u = 2.5 / 6.
    const double phi = 2 * kPi * 2.5 / 6, sine = std::sin(kPi / 3);
    const Vec3f local(float(sine * std::sin(phi)), 0.5f, float(-sine * std::cos(phi)));
    CHECK(map.radiance(frame.s * local.x + frame.t * local.y + frame.n * local.z).x == Approx(15).epsilon(1e-4));
}

TEST_CASE("offsets of camera samples are distributed as the filter, in both directions") {
    ReconstructionFilter::TentParameters tent;
    tent.radius = 1.75;
    ReconstructionFilter::GaussianParameters gaussian;
    gaussian.stddev = 0.6;
    uint64_t seed = 50;
    for (const ReconstructionFilter& filter :
         {ReconstructionFilter(), ReconstructionFilter(tent), ReconstructionFilter(gaussian)}) {
        const PixelOrder order(16, 12, filter);
        const double r = filter.radius();
        const int pixel = 16 * 5 + 7;
        CHECK_FIT(misfit(
            {7.5 - r, 7.5 + r, 5.5 - r, 5.5 + r, 20, 20},
            [&](Random& random) {
                const Vec2f p = order.raster(pixel, random.nextBlock());
                return Sample2{p.x, p.y};
            },
            [&](double px, double py) { return filter(px - 7.5) * filter(py - 5.5); }, ++seed));
    }
}

TEST_CASE("every pixel gets its n-th sample before any gets the next") {
    for (const auto& [width, height] : {std::pair(16, 12), {1, 1}, {2, 1}, {7, 5}, {256, 256}}) {
        const PixelOrder order(width, height, ReconstructionFilter());
        std::vector<int> counts(size_t(width * height), 0);
        for (uint64_t i = 0; i < 3 * counts.size(); ++i) {
            ++counts[size_t(order.pixel(i))];
            REQUIRE(counts[size_t(order.pixel(i))] == int(i / counts.size()) + 1);
        }
    }
}
