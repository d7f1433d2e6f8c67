// The rooms of the hard-scene library as geometry: closed meshes, and the numbers they are described by.

#include <set>

#include "tests/experiments/scenes/hard_scene.h"

using namespace ulam;

TEST_CASE("door_ajar: the gap is 2 w sin(θ/2) wide") {
    CHECK(2 * 59.7 * std::sin(radians(17.3 / 2)) == Approx(18.0).margin(0.05));
    for (const double angle : {2.0, 5.0, 10.0, 17.3, 45.0, 90.0}) {
        const auto description = describeGenerator(hard("door_ajar", {{"angle", angle}}));
        const Features features = description.generator()->features();
        REQUIRE(features.names == std::vector<std::string>{"gap"});
        CHECK(length(features.across) == Approx(2 * 59.7 * std::sin(radians(angle / 2))).epsilon(1e-5));
        CHECK(length(features.down) == Approx(121));
        const Surface door(description.dictionary()["door"]);
        checkClosed(door, 59.7 * 121 * 2.1);
        // A corner of the door is in the hinge, another at the gap's far side.
        for (const Vec3d& place : {Vec3d(62.0, 0, -72.4), Vec3d(features.corner + features.across + features.down)})
            CHECK(std::any_of(door.corners.begin(), door.corners.end(),
                              [&](const Vec3d& c) { return (c - place).length() < 1e-4; }));
        CHECK(door.lower().z == Approx(-72.4));  // the door opens into the viewer's room
    }
}

TEST_CASE("door_ajar: light passes the gap or goes over the door, nowhere else") {
    for (const double angle : {0.5, 17.3, 45.0, 90.0}) {
        const Scene scene = sceneOf("door_ajar", {{"angle", angle}, {"objects", 0}});
        const Imath::V2d hinge(62, -72.4), jamb(62 + 59.7, -72.4),
            edge = hinge + Imath::V2d(std::cos(radians(angle)), std::sin(radians(angle))) * 59.7;
        const auto inWedge = [&](double x, double z, double margin) {
            const auto leftOf = [&](const Imath::V2d& a, const Imath::V2d& b) {
                return (b.x - a.x) * (z - a.y) - (b.y - a.y) * (x - a.x) > -margin;
            };
            return leftOf(hinge, jamb) && leftOf(jamb, edge) && leftOf(edge, hinge);
        };
        int throughGap = 0, overDoor = 0;
        Random random({51, 52}, uint32_t(angle * 10), 0);
        for (int i = 0; i < 20000; ++i) {
            // From the plane between the two walls, where the frame leaves the doorway open.
            const Vec3f origin(float(62 + 59.7 * random()), float(121 * random()), -75);
            const Vec3f direction = squareToSphere(random(), random());
            if (direction.z <= 0.01f) continue;
            const Vertex v = firstHit(scene, origin, direction);
            const std::string& what = scene.shapes[v.shape].id;
            // Not those that do not leave the doorway.
            if (what == "frame" || v.position.z < -72.39f || inWedge(v.position.x, v.position.z, 0.01)) continue;
            if (scene.features.crossed(origin, v.position) == 0) {
                ++throughGap;
                continue;
            }
            const float t = (121 - origin.y) / direction.y;
            INFO("angle " << angle << ": " << what << " at " << v.position << " from " << origin);
            REQUIRE(t > 0);
            REQUIRE(inWedge(origin.x + t * direction.x, origin.z + t * direction.z, 0.01));
            ++overDoor;
        }
        CHECK(throughGap > 0);
        CHECK(overDoor > 0);
        CHECK(throughGap > overDoor);
    }
}

TEST_CASE("door_ajar: rooms, lamp, camera and pots are where they should be") {
    const Json dictionary = dictionaryOf("door_ajar");
    const Scene scene = sceneOf("door_ajar");
    checkCamera(scene, {-71.39, 71.49, 205.3}, {-71.1997, 71.4202, 204.321}, 54);
    checkBox(Surface(dictionary["walls"]), {-202.9, 0, -395.1}, {176.7, 145, 230.3});
    checkBox(Surface(dictionary["frame"]), {58.7, 0, -77.05}, {121.9, 123.3, -72.4});
    // What the door leaves of the doorway, through the wall and a little beyond.
    checkClosed(Surface(dictionary["frame"]), (63.2 * 123.3 - 59.7 * 121) * (77.05 - 72.4));
    CHECK(dictionary["walls"]["bsdf"]["reflectance"] == 0.73);
    CHECK(dictionary["floor"]["bsdf"]["reflectance"] == 0.73);

    const Surface lamp(dictionary["lamp"]);
    checkBox(lamp, {-117.2, 76.6, -321.8}, {34.4, 136.6, -321.8});
    CHECK(lamp.area() == Approx(151.6 * 60.0));
    CHECK(lamp.normal(0).z < 0);  // away from the doorway
    CHECK(vectorOf(dictionary["lamp"]["emitter"]["radiance"]) == Vec3d(1704, 1852, 1950));
    CHECK(emittedPower(sceneOf("door_ajar", {{"lamp_size", 0.1}}), "lamp") ==
          Approx(emittedPower(scene, "lamp")).epsilon(1e-5));

    const Json plastic = dictionaryOf("door_ajar", {{"floor", "rough_plastic"}, {"floor_alpha", 0.1}})["floor"]["bsdf"];
    CHECK(plastic["type"] == "roughplastic");
    CHECK(plastic["alpha"] == 0.1);

    const Surface table(dictionary["table"]);
    checkClosed(table, 88 * 60 * 3 + 4 * 4 * 4 * 39);
    const std::array<std::string, 3> materials{"roughconductor", "diffuse", "roughdielectric"};
    for (const int objects : {0, 1, 3, 4, 5, 12}) {
        const Json pots = dictionaryOf("door_ajar", {{"objects", objects}});
        CHECK(!pots.contains("pot_" + std::to_string(objects)));
        std::vector<Vec3d> lids;
        for (int i = 0; i < objects; ++i) {
            const Json &pot = pots["pot_" + std::to_string(i)], &lid = pots["lid_" + std::to_string(i)];
            CHECK(pot["bsdf"]["type"] == materials[size_t(i) % 3]);
            CHECK(lid["bsdf"] == pot["bsdf"]);
            const Surface body(pot);
            CHECK(body.boundary().empty());
            CHECK(body.volume() > 0.5 * (body.upper() - body.lower()).x * (body.upper() - body.lower()).y *
                                      (body.upper() - body.lower()).z);
            checkNormals(pot);
            CHECK(body.lower().y > table.upper().y);
            for (const int k : {0, 2}) {
                CHECK(body.lower()[k] > table.lower()[k]);
                CHECK(body.upper()[k] < table.upper()[k]);
            }
            // Lids touch nothing, pots do not meet.
            lids.push_back(vectorOf(lid["center"]));
            CHECK(lids.back().y - lid["radius"].get<double>() > body.upper().y);
            for (int j = 0; j < i; ++j)
                CHECK((lids.back() - lids[size_t(j)]).length() > (body.upper() - body.lower()).x);
        }
    }
}

TEST_CASE("door_ajar: both rooms are closed and look inwards") {
    for (const int objects : {0, 12}) {
        const Scene scene = sceneOf("door_ajar", {{"objects", objects}, {"angle", 45}});
        Random random({53, 54}, uint32_t(objects), 0);
        for (int i = 0; i < 20000; ++i) {
            const bool viewer = i % 2 == 0;
            // Above lamp, door and pots.
            const Vec3f origin(float(-200 + 370 * random()), float(138 + 6 * random()),
                               float(viewer ? -70 + 290 * random() : -390 + 310 * random()));
            const Vec3f direction = squareToSphere(random(), random());
            const Vertex v = firstHit(scene, origin, direction);
            const std::string& what = scene.shapes[v.shape].id;
            INFO(what << " from " << origin << " towards " << direction);
            REQUIRE((what == "lamp" || dot(v.normal, direction) < 0));
        }
    }
}

TEST_CASE("keyhole: the openings are 2.6 % of the ceiling, however many there are") {
    const double ceiling = 2.02 * 2.03, opening = (0.174 + 0.154) * (0.19 + 0.14);
    CHECK(opening / ceiling == Approx(0.026).margin(5e-4));
    for (const int holes : {1, 2, 3, 16})
        for (const double size : {0.02, 1.0, 4.0}) {
            const Json dictionary = dictionaryOf("keyhole", {{"holes", holes}, {"hole_size", size}});
            const Surface slab(dictionary["slab"]);
            double closed = 0;
            for (size_t i = 0; i < slab.triangles.size(); ++i)
                if (slab.normal(i).y < 0 && slab.corners[slab.triangles[i][0]].y == 1.99)
                    closed += slab.normal(i).length() / 2;
            INFO(holes << " holes a side, factor " << size);
            CHECK(ceiling - closed == Approx(opening * size * size).margin(1e-10));
            // Open only where it meets the walls, which are further than it is thick.
            for (const auto& [from, to] : slab.boundary())
                for (const size_t i : {from, to}) {
                    const Vec3d& c = slab.corners[i];
                    REQUIRE((std::abs(c.x + 0.01) == Approx(1.01) || std::abs(c.z + 0.025) == Approx(1.015)));
                }
        }
    checkBox(Surface(dictionaryOf("keyhole")["upper_box"]), {-1.02, 2.01, -1.04}, {1.0, 3.783, 0.99});
    checkBox(Surface(dictionaryOf("keyhole")["lower_box"]), {-1.02, 0, -1.04}, {1.0, 1.99, 0.99});
}

TEST_CASE("keyhole: each hole is a feature, and light comes down through them only") {
    for (const int holes : {1, 3, 16}) {
        const Scene scene = sceneOf("keyhole", {{"holes", holes}, {"hole_size", 2}});
        REQUIRE(scene.features.names.size() == size_t(holes * holes));
        for (int row = 0; row < holes; ++row)
            for (int column = 0; column < holes; ++column) {
                const Vec3f middle(float(-1.02 + 2.02 * (column + 0.5) / holes), 2,
                                   float(-1.04 + 2.03 * (row + 0.5) / holes));
                const uint32_t feature = scene.features.crossed(middle + Vec3f(0, 0.1f, 0), middle - Vec3f(0, 0.1f, 0));
                REQUIRE(feature == uint32_t(row * holes + column));
                REQUIRE(scene.features.names[feature] == "hole_" + std::to_string(row) + "_" + std::to_string(column));
                REQUIRE_FALSE(scene.rays().occluded(middle + Vec3f(0, 0.02f, 0), {0, -0.04f, 0}));
            }
        Random random({61, 62}, uint32_t(holes), 0);
        int passed = 0;
        for (int i = 0; i < 20000; ++i) {
            const bool above = i % 2 == 0;
            const Vec3f origin(float(-1 + 1.98 * random()),
                               float(above ? 2.06 + 1.7 * random() : 1.21 + 0.77 * random()),
                               float(-1 + 1.95 * random()));
            const Vec3f direction = squareToSphere(random(), random());
            Hit hit{};
            if (!scene.rays().intersect(origin, direction, hit)) {
                // The lower box is open in front.
                REQUIRE(direction.z > 0);
                if (above) {
                    REQUIRE(scene.features.crossed(origin, origin + direction * 20) != kNone);
                }
                continue;
            }
            Vertex v;
            scene.vertexAt(origin, direction, hit, v);
            const std::string& what = scene.shapes[v.shape].id;
            INFO(what << " at " << v.position << " from " << origin);
            REQUIRE((what == "lamp" || dot(v.normal, direction) < 0));
            if (what == "slab") continue;
            const bool between = (v.position.y > 2) != above;
            REQUIRE((scene.features.crossed(origin, v.position) != kNone) == between);
            passed += between;
        }
        CHECK(passed > 0);
    }
}

TEST_CASE("keyhole: lamp, blocks and camera") {
    const Json dictionary = dictionaryOf("keyhole");
    const Surface lamp(dictionary["lamp"]), blocks(dictionary["blocks"]);
    checkBox(lamp, {-0.907, 2.048, 0.098}, {-0.437, 2.048, 0.478});
    CHECK(lamp.normal(0).y > 0);  // away from the holes
    CHECK(lamp.upper().x < -0.174);
    for (const double offset : {0.0, 0.4, 0.85}) {
        const Surface moved(dictionaryOf("keyhole", {{"lamp_offset", offset}})["lamp"]);
        const Vec3d middle = (moved.lower() + moved.upper()) / 2 - Vec3d(-0.01, 2.048, -0.025);
        CHECK(middle.length() == Approx(offset).margin(1e-9));
        CHECK(moved.lower().x > -1.02);
        CHECK(moved.upper().z < 0.99);
    }
    CHECK(blocks.boundary().empty());
    CHECK(blocks.upper().y == 1.2);
    std::set<double> heights;
    for (const Vec3d& corner : blocks.corners) heights.insert(corner.y);
    CHECK(heights == std::set<double>{0, 0.6, 1.2});
    // Bases of 0.6 × 0.6, up to the measurements' rounding.
    CHECK(blocks.volume() == Approx(0.36 * 1.8).epsilon(0.02));
    checkCamera(sceneOf("keyhole"), {0, 1, 6.8}, {0, 1, 0}, 19.5);
}

TEST_CASE("egg_room: egg, table, lamps and camera") {
    const Json dictionary = dictionaryOf("egg_room");
    const Scene scene = sceneOf("egg_room");
    checkBox(Surface(dictionary["room"]), {-2.745, -2.208, -1.941}, {1.646, 2.051, 1.954});
    CHECK(dictionary["room"]["bsdf"]["reflectance"] == 0.5);
    const Surface egg(dictionary["egg"]), table(dictionary["table"]);
    // It stands a thousandth above the table.
    checkBox(egg, {-0.245, 0.60 - 0.245, -0.699}, {0.245, 0.60 + 0.245, -0.079});
    CHECK((egg.lower().z + egg.upper().z) / 2 == Approx(-0.39).margin(1.1e-3));
    CHECK(egg.lower().z > table.upper().z);
    // A sphere's profile in 96 parts of equal angle, turned: cones between circles at equal angles have, together, all
    // but O(1 / 96²) of the volume 4/3 π a² c.
    CHECK(egg.boundary().empty());
    CHECK(egg.volume() == Approx(4 / 3.0 * kPi * 0.245 * 0.245 * 0.31).epsilon(2e-3));
    checkNormals(dictionary["egg"]);
    CHECK(dictionary["egg"]["bsdf"]["int_ior"] == 1.5);
    CHECK(dictionaryOf("egg_room", {{"ior", 2}})["egg"]["bsdf"]["int_ior"] == 2.0);
    CHECK(table.upper().z == Approx(-0.70));
    CHECK((table.upper() - table.lower()).x == Approx(2.32));
    CHECK((table.upper() - table.lower()).y == Approx(1.80));
    CHECK(table.lower().z == Approx(-1.941));
    checkClosed(table, 2.32 * 1.80 * 0.05 + 4 * 0.11 * 0.11 * (1.941 - 0.75));

    const Surface lamp(dictionary["lamp"]), dish(dictionary["dish"]), spot(dictionary["spot"]);
    CHECK(lamp.area() == Approx(0.28 * 0.22));
    CHECK(lamp.lower().z == Approx(1.004));
    CHECK(lamp.normal(0).z > 0);
    CHECK(dish.upper().z == Approx(1.16));
    for (const int k : {0, 1}) {
        CHECK(lamp.lower()[k] > dish.lower()[k]);
        CHECK(lamp.upper()[k] < dish.upper()[k]);
    }
    CHECK(radianceOf(dictionary["lamp"]) == 500);
    const Vec3d extents = spot.upper() - spot.lower(), middle = (spot.upper() + spot.lower()) / 2;
    CHECK((extents - Vec3d(0.05, 0.11, 0.13)).length() < 1e-9);
    CHECK((middle - Vec3d(1.33, 0.86, 0.55)).length() < 1e-9);
    CHECK(vectorOf(dictionary["spot"]["emitter"]["radiance"]) == Vec3d(7000, 5450, 3630));
    // It shines through the open end of its tube.
    const Json& tube = dictionary["tube"];
    const Vec3d p0 = vectorOf(tube["p0"]), p1 = vectorOf(tube["p1"]);
    CHECK(spot.normal(0).normalized().dot((p1 - p0).normalized()) == Approx(1));
    const Vertex lit = firstHit(scene, Vec3f(middle + spot.normal(0).normalized() * 1e-3), Vec3f(p1 - p0).normalized());
    CHECK(scene.shapes[lit.shape].id != "tube");
    CHECK(scene
              .shapes[firstHit(scene, Vec3f(middle - spot.normal(0).normalized() * 1e-3), Vec3f(p0 - p1).normalized())
                          .shape]
              .id == "tube_end");
    const Vec3f eye = scene.sensor->samplePosition({}).position;
    CHECK(length(eye - Vec3f(-0.224f, -6.642f, 0.366f)) < 1e-6f);
    CHECK(dictionary["sensor"]["fov"] == 44.55);
    // The camera sees the egg, and the room is open in front only.
    CHECK(scene.shapes[firstHit(scene, eye, normalize(Vec3f(0, 0.6f, -0.39f) - eye)).shape].id == "egg");
    Random random({81, 82}, 0, 0);
    for (int i = 0; i < 20000; ++i) {
        const Vec3f origin(float(-2.7 + 4.3 * random()), float(-2.2 + 4.2 * random()), float(1.2 + 0.7 * random()));
        const Vec3f direction = squareToSphere(random(), random());
        Hit hit{};
        if (!scene.rays().intersect(origin, direction, hit)) {
            REQUIRE(direction.y < 0);
            continue;
        }
        Vertex v;
        scene.vertexAt(origin, direction, hit, v);
        if (scene.shapes[v.shape].id == "room" || scene.shapes[v.shape].id == "table") {
            REQUIRE(dot(v.normal, direction) < 0);
        }
    }
}

TEST_CASE("mirror_caustic_room: the mirror gets just its share of the sun") {
    // The sun's parallel light maps the window to the mirror's plane by a shear, which keeps ratios of areas. The
    // mirror reaches beyond the window's image but on one side, where it ends at the share of the image's width.
    for (const double share : {1e-5, 0.02, 0.1, 0.5, 1.0}) {
        const Scene scene = sceneOf("mirror_caustic_room", {{"share", share}});
        REQUIRE(scene.features.names == std::vector<std::string>{"window"});
        const Vec3f corner = scene.features.corner, across = scene.features.across, down = scene.features.down;
        CHECK(length(across) == Approx(0.8));
        CHECK(length(down) == Approx(0.5));
        const Vec3f sun = Vec3f(float(-std::cos(radians(50))), float(-std::sin(radians(50))), 0);
        const auto landsOn = [&](double x, double y) {
            const Vec3f through = corner + across * float(x) + down * float(y);
            return scene.shapes[firstHit(scene, through - sun, sun).shape].id;
        };
        // Single precision places the mirror's edge to about 3e-8, of 0.8.
        constexpr double kEdge = 1e-6;
        for (int i = 0; i < 50; ++i) {
            const double y = (i + 0.5) / 50, edge = 1 - share;
            INFO("share " << share << " at " << y);
            CHECK(landsOn(edge + kEdge, y) == "mirror");
            if (share < 1) CHECK(landsOn(edge - kEdge, y) == "room");
            for (int j = 0; j < 50; ++j) {
                const double x = (j + 0.5) / 50;
                if (std::abs(x - edge) > kEdge) CHECK(landsOn(x, y) == (x > edge ? "mirror" : "room"));
            }
        }
        // Light that the mirror sends on meets the wall −x.
        const Vec3f through = corner + across * float(1 - share / 2) + down * 0.5f;
        const Vertex mirror = firstHit(scene, through, sun);
        const Vertex wall = firstHit(scene, mirror.position + Vec3f(0, 1e-4f, 0), {sun.x, -sun.y, 0});
        CHECK(wall.position.x == Approx(-1).margin(1e-6));
    }
}

TEST_CASE("mirror_caustic_room: closed but for the window, and it looks inwards") {
    const Scene scene = sceneOf("mirror_caustic_room");
    Random random({91, 92}, 0, 0);
    int escaped = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f origin(float(1.98 * random() - 0.99), float(0.01 + 1.98 * random()), float(1.98 * random() - 0.99));
        const Vec3f direction = squareToSphere(random(), random());
        Hit hit{};
        if (!scene.rays().intersect(origin, direction, hit)) {
            REQUIRE(scene.features.crossed(origin, origin + direction * 10) == 0);
            ++escaped;
            continue;
        }
        Vertex v;
        scene.vertexAt(origin, direction, hit, v);
        REQUIRE(dot(v.normal, direction) < 0);
        REQUIRE(scene.features.crossed(origin, v.position - direction * 1e-4f) == kNone);
    }
    CHECK(escaped > 0);
    const Json sun = dictionaryOf("mirror_caustic_room")["sun"];
    CHECK(sun["type"] == "directional");
    CHECK(sun["irradiance"] == 20);
    CHECK(dictionaryOf("mirror_caustic_room")["mirror"]["bsdf"]["type"] == "conductor");
}

TEST_CASE("glossy Cornell box: blocks of metal and plastic in the measured room") {
    const Json dictionary = dictionaryOf("cornell_box", {{"alpha", 0.02}});
    checkCamera(sceneOf("cornell_box"), {278, 273, -800}, {278, 273, -799}, 39.3077);
    checkBox(Surface(dictionary["light"]), {213, 548.3, 227}, {343, 548.3, 332});
    CHECK(Surface(dictionary["light"]).normal(0).y < 0);
    CHECK(Surface(dictionary["room"]).upper().z == 559.2);
    CHECK(Surface(dictionary["room"]).upper().y == 548.8);
    CHECK(Surface(dictionary["red_wall"]).lower().x == 549.6);
    CHECK(dictionary["tall"]["bsdf"]["type"] == "roughconductor");
    CHECK(dictionary["short"]["bsdf"]["type"] == "roughplastic");
    for (const auto& [name, height] : {std::pair("tall", 330.0), std::pair("short", 165.0)}) {
        CHECK(dictionary[name]["bsdf"]["alpha"] == 0.02);
        const Surface block(dictionary[name]);
        CHECK(block.upper().y == height);
        // Open at the floor, which it stands on.
        const auto boundary = block.boundary();
        CHECK(boundary.size() == 4);
        for (const auto& [from, to] : boundary) CHECK(block.corners[from].y == 0);
        CHECK(block.volume() > 0);
    }
}
