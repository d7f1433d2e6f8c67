// The free-standing scenes of the hard-scene library as geometry: plates, glass, rings, water and beads, and the numbers
// they are described by.


#include "tests/experiments/scenes/hard_scene.h"

using namespace ulam;

TEST_CASE("mis_plates: lights of equal power") {
    const std::array<std::array<double, 3>, 4> lights{
        {{-3.75, 0.03333, 901.803}, {-1.25, 0.1, 100}, {1.25, 0.3, 11.1111}, {3.75, 0.9, 1.23457}}};
    const Json dictionary = dictionaryOf("mis_plates"), smaller = dictionaryOf("mis_plates", {{"light_size", 0.25}});
    for (size_t i = 0; i < lights.size(); ++i) {
        const auto& [x, radius, radiance] = lights[i];
        const std::string name = "light_" + std::to_string(i);
        CHECK(vectorOf(dictionary[name]["center"]) == Vec3d(x, 0, 0));
        CHECK(dictionary[name]["radius"] == radius);
        CHECK(radianceOf(dictionary[name]) == radiance);
        CHECK(smaller[name]["radius"] == 0.25 * radius);
        const auto power = [&](const Json& d) {
            return 4 * kPi * kPi * std::pow(d[name]["radius"].get<double>(), 2) * radianceOf(d[name]);
        };
        // The numbers are rounded: 0.03333² of four digits makes 0.2 %.
        CHECK(power(dictionary) == Approx(4 * kPi * kPi).epsilon(2e-3));
        CHECK(power(smaller) == Approx(power(dictionary)));
    }
    CHECK(vectorOf(dictionary["fill_light"]["center"]) == Vec3d(10, 10, 4));
    CHECK(dictionary["fill_light"]["radius"] == 0.5);
    CHECK(radianceOf(dictionary["fill_light"]) == 800);
}

TEST_CASE("mis_plates: every plate shows the camera a reflection of the lights") {
    const std::array<std::array<double, 5>, 4> plates{{{-2.70651, 0.25609, -2.08375, -0.526323, 0.005},
                                                       {-3.28825, 1.36972, -2.83856, 0.476536, 0.02},
                                                       {-3.73096, 2.70046, -3.43378, 1.74564, 0.05},
                                                       {-3.99615, 4.0667, -3.82069, 3.08221, 0.1}}};
    const Json dictionary = dictionaryOf("mis_plates"), rougher = dictionaryOf("mis_plates", {{"roughness", 4}});
    checkCamera(sceneOf("mis_plates"), {0, 2, 15}, {0, -2, 2.5}, 28, false);
    for (size_t i = 0; i < plates.size(); ++i) {
        const auto& [frontY, frontZ, rearY, rearZ, alpha] = plates[i];
        const Json& plate = dictionary["plate_" + std::to_string(i)];
        checkBox(Surface(plate), {-4, frontY, rearZ}, {4, rearY, frontZ});
        const Json& bsdf = plate["bsdf"]["bsdf"];
        CHECK(bsdf["type"] == "roughplastic");
        CHECK(bsdf["alpha"] == alpha);
        CHECK(bsdf["int_ior"] == 2.0);
        CHECK(vectorOf(bsdf["diffuse_reflectance"]) == Vec3d(0.07, 0.09, 0.13));
        CHECK(rougher["plate_" + std::to_string(i)]["bsdf"]["bsdf"]["alpha"] == 4 * alpha);
        // In the plane x = 0: the camera's mirror image behind the plate sees the lights' axis, y = z = 0, through it.
        const Imath::V2d front(frontY, frontZ), rear(rearY, rearZ), along = rear - front, camera(2, 15);
        const Imath::V2d normal = Imath::V2d(-along.y, along.x).normalized();
        const Imath::V2d image = camera - normal * (2 * normal.dot(camera - front));
        const double t = normal.dot(front - image) / normal.dot(-image);
        const double place = along.dot(image * (1 - t) - front) / along.dot(along);
        INFO("plate " << i << ", at " << place << " of the way to its rear edge");
        CHECK(place > 0);
        CHECK(place < 1);
    }
    const Surface walls(dictionary["walls"]);
    CHECK(walls.lower().y == -4.14615);
    CHECK(walls.lower().z == -2);
    CHECK(dictionary["walls"]["bsdf"]["reflectance"] == 0.4);
}

TEST_CASE("torus_in_glass: a torus inside a closed block") {
    const Json dictionary = dictionaryOf("torus_in_glass");
    const Surface torus(dictionary["torus"]), block(dictionary["block"]);
    // Pappus: 2π R times the area of the profile, a 64-gon, and the 160-gon that it is turned along.
    const double profile = kPi * 0.22 * 0.22 * roundness(64);
    checkClosed(torus, 2 * kPi * 0.6 * profile * roundness(160));
    checkNormals(dictionary["torus"]);
    // Vertices − edges + faces is 0 on a torus; every edge has two triangles.
    CHECK(torus.corners.size() - torus.triangles.size() / 2 == 0);
    checkClosed(block, 8);
    checkBox(block, {-1, 0.01, -1}, {1, 2.01, 1});
    for (int k = 0; k < 3; ++k) {
        CHECK(torus.lower()[k] > block.lower()[k]);
        CHECK(torus.upper()[k] < block.upper()[k]);
    }
    CHECK(dictionary["block"]["bsdf"]["type"] == "dielectric");
    CHECK(dictionary["block"]["bsdf"]["int_ior"] == 1.5);
    for (const double alpha : {0.01, 0.05}) {
        const Json rough = dictionaryOf("torus_in_glass", {{"alpha", alpha}})["block"]["bsdf"];
        CHECK(rough["type"] == "roughdielectric");
        CHECK(rough["alpha"] == alpha);
    }
    for (const double width : {0.25, 1.0, 5.0})
        checkDiscLight(sceneOf("torus_in_glass", {{"light_width", width}}), {-4, 7.01, 2.5}, {0, 1.01, 0}, width, 5);
    checkCamera(sceneOf("torus_in_glass"), {3.9, 4.4, 5.0}, {0, 0.85, 0}, 34.6);
}

TEST_CASE("ring: the cusp of the caustic is where mirrors focus") {
    // Near the axis a circle of radius R is a mirror of focal length R / 2: a light at s from it has its image at s'
    // with 1/s + 1/s' = 2/R, the mirror equation (Born and Wolf, "Principles of Optics", 4.4.2), s' = sR / (2s − R).
    // The rays touch their envelope there, the cusp. A vertical wall keeps a ray's slope, so seen from above rays are
    // those of the plane. Rays at the small angle φ from the axis miss the image by O(φ²).
    constexpr double kAside = 0.01, kLightDistance = 10;
    for (const double radius : {0.5, 1.0, 7.0})
        for (const double angle : {10.0, 30.0, 60.0}) {
            const Scene scene = sceneOf("ring", {{"radius", radius}, {"height", 2}, {"light_angle", angle}});
            const Vec3d light =
                Vec3d(-std::cos(radians(angle)), std::sin(radians(angle)), 0) * (kLightDistance * radius);
            const double s = radius - light.x, image = s * radius / (2 * s - radius), cusp = radius - image;
            CHECK(cusp > radius * 0.35);
            CHECK(cusp < radius * 0.5);
            // The wall's point from which light comes down to the floor just at the axis: by similar triangles.
            const Vec3d wall(radius * std::cos(kAside), light.y * image / (s + image), radius * std::sin(kAside));
            const Vertex onWall = firstHit(scene, Vec3f(wall * 0.9), Vec3f((wall * Vec3d(1, 0, 1)).normalized()));
            REQUIRE(scene.shapes[onWall.shape].id == "ring");
            const Vec3d n(onWall.normal), in = (wall - light).normalized(), out = in - n * (2 * n.dot(in));
            CHECK(std::abs(n.y) < 1e-6);
            const double t = -wall.z / out.z;
            INFO("radius " << radius << ", angle " << angle);
            CHECK(wall.x + t * out.x == Approx(cusp).epsilon(1e-3));
            CHECK(wall.y + t * out.y == Approx(0).margin(2e-3 * radius));
            const Vertex lit = firstHit(scene, Vec3f(wall - n * (n.dot(wall) > 0 ? 1e-4 : -1e-4) * radius), Vec3f(out));
            CHECK(scene.shapes[lit.shape].id == "floor");
        }
}

TEST_CASE("ring: the cusp is lit where the ring is neither too low nor too high") {
    // The ray that is reflected to the cusp meets the wall at the height h = H s' / (s + s'), H the light's, and comes
    // over the near edge at h + 2 H / (s + s') (in radii). A far light would make that 0.5 and 2.5 times the tangent of
    // light_angle; at 10 radii it is less, and from 0.46 to 1.9 times lies within for angles of up to 60°.
    for (const double angle : {10.0, 30.0, 50.0, 60.0}) {
        const double height = 10 * std::sin(radians(angle)), s = 10 * std::cos(radians(angle)) + 1,
                     image = s / (2 * s - 1);
        const double low = height * image / (s + image), high = low + 2 * height / (s + image);
        const auto lit = [&](double ring) {
            const Scene scene = sceneOf("ring", {{"height", ring}, {"light_angle", angle}});
            const Vec3f light(float(1 - s), float(height), 0), wall(1, float(low), 0);
            const Vec3f origin = light + (wall - light) * 1e-2f, direction = normalize(wall - light);
            Hit hit{};
            if (!scene.rays().intersect(origin, direction, hit)) return false;
            Vertex v;
            scene.vertexAt(origin, direction, hit, v);
            return scene.shapes[v.shape].id == "ring" && length(v.position - wall) < 1e-3f;
        };
        INFO("angle " << angle << ": from " << low << " to " << high);
        CHECK(low < 0.46 * std::tan(radians(angle)));
        CHECK(high > 1.9 * std::tan(radians(angle)));
        CHECK_FALSE(lit(std::max(0.05, low * 0.98)));
        CHECK(lit(low * 1.02));
        if (high < 1.9) {
            CHECK(lit(high * 0.98));
            CHECK_FALSE(lit(high * 1.02));
        }
    }
    for (const double angle : {10.0, 30.0, 80.0})
        for (const double width : {0.05, 0.53, 20.0}) {
            const Scene scene = sceneOf("ring", {{"light_angle", angle}, {"light_width", width}, {"radius", 2}});
            checkDiscLight(scene, Vec3d(-std::cos(radians(angle)), std::sin(radians(angle)), 0) * 20, {0, 0, 0}, width,
                           4);
        }
    const Json ring = dictionaryOf("ring", {{"alpha", 0.02}, {"radius", 3}, {"height", 0.5}})["ring"];
    CHECK(ring["radius"] == 3.0);
    CHECK(ring["p1"][1] == 1.5);
    CHECK(ring["bsdf"]["bsdf"]["type"] == "roughconductor");
    CHECK(dictionaryOf("ring")["ring"]["bsdf"]["bsdf"]["type"] == "conductor");
}

TEST_CASE("pool: water that is as high and as wide as it should be") {
    for (const auto& [waves, amplitude, wavelength] :
         {std::tuple(1, 0.12, 0.2), std::tuple(8, 0.03, 0.5), std::tuple(64, 0.0, 2.0)}) {
        const Json dictionary =
            dictionaryOf("pool", {{"waves", waves}, {"amplitude", amplitude}, {"wavelength", wavelength}});
        const Surface water(dictionary["water"]);
        checkNormals(dictionary["water"]);
        for (size_t i = 0; i < water.triangles.size(); ++i) REQUIRE(water.normal(i).y > 0);
        for (const Vec3d& corner : water.corners) REQUIRE(std::abs(corner.y) <= amplitude);
        // Single sines are sampled closely enough to show their crests.
        if (waves == 1) CHECK(water.upper().y == Approx(amplitude).epsilon(1e-2));
        CHECK(water.lower().x == -1);
        CHECK(water.upper().z == 1);
        // Open at the tiles only.
        for (const auto& [from, to] : water.boundary())
            for (const size_t i : {from, to})
                REQUIRE((std::abs(water.corners[i].x) == 1 || std::abs(water.corners[i].z) == 1));
        const double cells = std::sqrt(double(water.triangles.size()) / 2);
        // Wavelengths differ by a factor of √2 both ways.
        CHECK(wavelength / std::sqrt(2.0) / (2 / cells) >= 24);
    }
    CHECK(dictionaryOf("pool") == dictionaryOf("pool", {{"seed", 1}}));
    CHECK(dictionaryOf("pool")["water"] != dictionaryOf("pool", {{"seed", 2}})["water"]);
    for (const double radius : {1e-4, 0.05, 0.5}) {
        const Json light = dictionaryOf("pool", {{"light_radius", radius}})["light"];
        // Of a sphere: π L times its area.
        CHECK(kPi * radianceOf(light) * 4 * kPi * radius * radius == Approx(250));
    }
}

TEST_CASE("pool: neither camera nor light sees the tiles below but through water") {
    const Scene scene = sceneOf("pool");
    const Vec3f eye = scene.sensor->samplePosition({}).position, light(-0.5f, 2.6f, -0.6f);
    Random random({71, 72}, 0, 0);
    int seen = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f to(float(1.998 * random() - 0.999), float(-0.8 * random()), float(1.998 * random() - 0.999));
        for (const Vec3f& from : {eye, light - Vec3f(0, 0.06f, 0)}) {
            const Vertex v = firstHit(scene, from, normalize(to - from));
            const std::string& what = scene.shapes[v.shape].id;
            INFO(what << " at " << v.position);
            REQUIRE((v.position.y > -0.03f || what == "water"));
            seen += what == "water";
        }
    }
    CHECK(seen > 10000);
    // From within, nothing but water is not a tile; tiles look inwards.
    for (int i = 0; i < 20000; ++i) {
        const Vec3f origin(float(1.98 * random() - 0.99), float(-0.79 + 0.7 * random()), float(1.98 * random() - 0.99));
        const Vec3f direction = squareToSphere(random(), random());
        const Vertex v = firstHit(scene, origin, direction);
        const std::string& what = scene.shapes[v.shape].id;
        REQUIRE((what == "water" || what == "light_tiles" || what == "dark_tiles"));
        REQUIRE((dot(v.normal, direction) < 0) == (what != "water"));
    }
}

TEST_CASE("necklace: beads of one size at equal distances along the curve") {
    // Length of r(φ) = 1 + 0.25 cos 3φ: ∫ √(r² + r'²) dφ, whose trapezoidal rule converges exponentially.
    double curve = 0;
    constexpr int kSteps = 4096;
    for (int i = 0; i < kSteps; ++i) {
        const double turn = 2 * kPi * i / kSteps;
        curve += std::hypot(1 + 0.25 * std::cos(3 * turn), 0.75 * std::sin(3 * turn)) * 2 * kPi / kSteps;
    }
    for (const int beads : {8, 64, 333, 2000}) {
        const Json dictionary = dictionaryOf("necklace", {{"beads", beads}});
        CHECK(!dictionary.contains("bead_" + std::to_string(beads)));
        std::vector<Vec3d> centers;
        const double radius = dictionary["bead_0"]["radius"];
        for (int i = 0; i < beads; ++i) {
            const Json& bead = dictionary["bead_" + std::to_string(i)];
            REQUIRE(bead["radius"] == radius);
            const Vec3d c = vectorOf(bead["center"]);
            REQUIRE(c.y == radius);  // it stands on the floor
            REQUIRE(std::hypot(c.x, c.z) == Approx(1 + 0.25 * std::cos(3 * std::atan2(c.z, c.x))));
            centers.push_back(c);
        }
        double shortest = 1e9, longest = 0;
        for (size_t i = 0; i < centers.size(); ++i) {
            for (size_t j = 0; j < i; ++j) REQUIRE((centers[i] - centers[j]).length() >= 2 * radius);
            const double step = (centers[i] - centers[(i + 1) % centers.size()]).length();
            shortest = std::min(shortest, step), longest = std::max(longest, step);
        }
        INFO(beads << " beads, " << shortest << " to " << longest);
        CHECK(2 * radius == Approx(0.98 * shortest));
        // Chords of equal arcs: none is longer than its arc, and the more there are, the nearer they come to it. Places
        // are corners of a polygon of 2^16, so a step may miss two corners' distance.
        const double arc = curve / beads, corner = curve / (1 << 16) * 1.5;
        CHECK(longest <= arc + 2 * corner);
        if (beads >= 64) CHECK(shortest >= arc * 0.98 - 2 * corner);
    }
    CHECK(dictionaryOf("necklace", {{"alpha", 0.1}})["metal"]["alpha"] == 0.1);
    for (const double width : {0.1, 2.0, 20.0})
        checkDiscLight(sceneOf("necklace", {{"light_width", width}}), {-4, 5, -3}, {0, 0, 0}, width, 3);
}
