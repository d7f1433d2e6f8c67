// The hard-scene library as geometry: knobs, closed meshes, and the numbers that its scenes are described by.

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "core/scene/plugins.h"
#include "tests/experiments/scenes/generated.h"

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

/// A scene of the library; the Cornell box is the glossy one.
Json hard(const std::string& generator, Json knobs = Json::object()) {
    knobs["type"] = generator;
    if (generator == "cornell_box") knobs["variant"] = "glossy";
    return knobs;
}

Json dictionaryOf(const std::string& generator, const Json& knobs = Json::object()) {
    return describeGenerator(hard(generator, knobs)).dictionary();
}

Scene sceneOf(const std::string& generator, const Json& knobs = Json::object()) {
    return describeGenerator(hard(generator, knobs)).build();
}

double radians(double degrees) {
    return degrees * kPi / 180;
}

Vec3d vectorOf(const Json& json) {
    return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

/// Green's, of a light.
double radianceOf(const Json& shape) {
    const Json& radiance = shape["emitter"]["radiance"];
    return radiance.is_array() ? radiance[1].get<double>() : radiance.get<double>();
}

/// Corners and triangles as a dictionary's `mesh` has them.
struct Surface {
    std::vector<Vec3d> corners;
    std::vector<std::array<size_t, 3>> triangles;

    explicit Surface(const Json& mesh) {
        const Json &p = mesh["positions"], &t = mesh["triangles"];
        for (size_t i = 0; i < p.size(); i += 3)
            corners.emplace_back(p[i].get<double>(), p[i + 1].get<double>(), p[i + 2].get<double>());
        for (size_t i = 0; i < t.size(); i += 3)
            triangles.push_back({t[i].get<size_t>(), t[i + 1].get<size_t>(), t[i + 2].get<size_t>()});
    }

    Vec3d lower() const {
        Vec3d result = corners[0];
        for (const Vec3d& c : corners)
            for (int k = 0; k < 3; ++k) result[k] = std::min(result[k], c[k]);
        return result;
    }
    Vec3d upper() const {
        Vec3d result = corners[0];
        for (const Vec3d& c : corners)
            for (int k = 0; k < 3; ++k) result[k] = std::max(result[k], c[k]);
        return result;
    }
    /// Of length twice the area.
    Vec3d normal(size_t triangle) const {
        const auto& [i, j, k] = triangles[triangle];
        return (corners[j] - corners[i]).cross(corners[k] - corners[i]);
    }
    double area() const {
        double sum = 0;
        for (size_t i = 0; i < triangles.size(); ++i) sum += normal(i).length() / 2;
        return sum;
    }
    /// By the divergence theorem: positive where a closed surface's normals point outwards.
    double volume() const {
        double sum = 0;
        for (const auto& [i, j, k] : triangles) sum += corners[i].dot(corners[j].cross(corners[k])) / 6;
        return sum;
    }
    /// Edges that triangles do not pass as often in one direction as in the other; once each, but where boxes of a mesh
    /// touch along an edge.
    std::vector<std::pair<size_t, size_t>> boundary() const {
        std::map<std::pair<size_t, size_t>, int> passes;
        for (const auto& t : triangles)
            for (size_t k = 0; k < 3; ++k) {
                const size_t from = t[k], to = t[(k + 1) % 3];
                passes[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
            }
        std::vector<std::pair<size_t, size_t>> result;
        for (const auto& [edge, difference] : passes)
            if (difference != 0) result.push_back(edge);
        return result;
    }
};

/// A closed surface that looks outwards and holds this volume.
void checkClosed(const Surface& surface, double volume) {
    CHECK(surface.boundary().empty());
    CHECK(surface.volume() == Approx(volume).epsilon(1e-9));
}

void checkBox(const Surface& surface, const Vec3d& lower, const Vec3d& upper) {
    for (int k = 0; k < 3; ++k) {
        CHECK(surface.lower()[k] == Approx(lower[k]).margin(1e-9));
        CHECK(surface.upper()[k] == Approx(upper[k]).margin(1e-9));
    }
}

/// Vertex normals that agree with the triangles they stand at.
void checkNormals(const Json& mesh) {
    const Surface surface(mesh);
    const Json& n = mesh["normals"];
    REQUIRE(n.size() == 3 * surface.corners.size());
    for (size_t t = 0; t < surface.triangles.size(); ++t)
        for (const size_t corner : surface.triangles[t])
            REQUIRE(surface.normal(t).dot({n[3 * corner].get<double>(), n[3 * corner + 1].get<double>(),
                                           n[3 * corner + 2].get<double>()}) > 0);
}

/// ∬ of a profile's polygon turned into an n-gon: a body of revolution of `sides` sides has this share of the volume of
/// the round one with the same polygon as profile.
double roundness(int sides) {
    return sides * std::sin(2 * kPi / sides) / (2 * kPi);
}

/// Where the camera stands, the middle of its image, and the angle that the image's width (or height) spans.
void checkCamera(const Scene& scene, const Vec3d& origin, const Vec3d& target, double fov, bool alongWidth = true) {
    const Vec3f eye = scene.sensor->samplePosition({}).position;
    CHECK(length(eye - Vec3f(origin)) < 1e-4f);
    const float w = float(scene.sensor->width()), h = float(scene.sensor->height());
    const auto direction = [&](float x, float y) {
        return scene.sensor->direction(scene.sensor->samplePosition({}), {x, y});
    };
    const Vec3f ahead = direction(w / 2, h / 2);
    CHECK(dot(ahead, normalize(Vec3f(target - origin))) == Approx(1).epsilon(1e-5));
    const Vec3f side = alongWidth ? direction(0, h / 2) : direction(w / 2, 0);
    CHECK(std::acos(double(dot(ahead, side))) == Approx(radians(fov / 2)).epsilon(1e-4));
}

/// A disc seen from `target` under an angle (degrees), whose irradiance there is given.
void checkDiscLight(const Scene& scene, const Vec3d& center, const Vec3d& target, double width, double irradiance) {
    const Shape& light = scene.shapes[shapeNamed(scene, "light")];
    const Disk& disk = std::get<Disk>(light.geometry);
    CHECK(length(disk.center - Vec3f(center)) < 1e-5 * center.length());
    CHECK(dot(disk.normal, normalize(Vec3f(target - center))) == Approx(1).epsilon(1e-6));
    const double half = std::atan(double(length(disk.axisX)) / (target - center).length());
    CHECK(half == Approx(radians(width / 2)).epsilon(1e-5));
    CHECK(length(disk.axisX) == Approx(length(disk.axisY)));
    // E = π L sin² of the disc's half angle (Lambert 1760).
    CHECK(kPi * std::get<AreaEmitter>(scene.emitters[light.emitter]).emitted.x * std::pow(std::sin(half), 2) ==
          Approx(irradiance).epsilon(1e-5));
}

double emittedPower(const Scene& scene, const std::string& name) {
    const Shape& light = scene.shapes[shapeNamed(scene, name)];
    return kPi * light.area * luminance(std::get<AreaEmitter>(scene.emitters[light.emitter]).emitted);
}

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
