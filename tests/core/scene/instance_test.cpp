// Shape groups and instances: an instance is what the shapes of its group are, written out at its place.

#include "core/base/random.h"
#include "core/render/driver.h"
#include "core/scene/mesh_io.h"
#include "tests/core/scene/load_text.h"
#include "tests/support/level.h"

using namespace ulam;

namespace {

bool alike(const Vec3f& a, const Vec3f& b, float tolerance = 2e-5f) { return length(a - b) <= tolerance * std::max(1.0f, length(b)); }

/// A patch of a wavy surface, with normals and texture coordinates.
Mesh wave() {
    Mesh mesh;
    constexpr int kSide = 8;
    for (int i = 0; i <= kSide; ++i)
        for (int j = 0; j <= kSide; ++j) {
            const float x = 2 * float(i) / kSide - 1, y = 2 * float(j) / kSide - 1;
            mesh.positions.emplace_back(x, y, 0.2f * std::sin(3 * x) * std::cos(2 * y));
            mesh.normals.push_back(normalize(Vec3f(-0.6f * std::cos(3 * x) * std::cos(2 * y), 0.4f * std::sin(3 * x) * std::sin(2 * y), 1)));
            mesh.texcoords.emplace_back(x * 0.7f + 0.1f * y, y * y + y);
        }
    for (uint32_t i = 0; i < kSide; ++i)
        for (uint32_t j = 0; j < kSide; ++j) {
            const uint32_t a = i * (kSide + 1) + j, b = a + kSide + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

Json step(const char* type, const Json& value) { return {{"type", type}, {"value", value}}; }
Json turn(const Json& axis, double angle) { return {{"type", "rotate"}, {"axis", axis}, {"angle", angle}}; }

// Braces around one value alone mean a list to some compilers, and that value to others.
const Json kShift = Json::array({step("translate", {0.5, -0.25, 2})});
const Json kTurned = {turn({1, 2, 3}, 50), step("scale", 1.7), step("translate", {0.5, -0.3, 2})};
const Json kStretched = {step("scale", {2, 0.5, 1.2}), turn({1, -1, 0.3}, 110), step("translate", {-1, 0.3, 0.6})};
const Json kMirrored = {step("scale", {1, -1.5, 0.8}), turn({0, 1, 1}, 25)};
const Json kSheared = Json::array({step("matrix", {1, 0.5, 0, 1, 0, 1, -0.4, 0, 0.3, 0, 1, 0.5, 0, 0, 0, 1})});

/// The same shapes as an instance of a group and written out, in the order in which an instance has them.
struct Twins {
    SceneFolder folder{"instance_test"};
    Scene instanced, flat;

    explicit Twins(const Json& toWorld, bool round) : instanced(load(toWorld, round, true)), flat(load(toWorld, round, false)) {}

    Scene load(const Json& toWorld, bool round, bool asInstance) {
        folder.write("wave.ply", plyBytes(wave()));
        Json members = {{"wave", {{"type", "ply"}, {"filename", "wave.ply"}, {"to_world", Json::array({turn({0, 1, 0}, 20)})}, {"bsdf", {{"type", "diffuse"}, {"reflectance", {0.7, 0.4, 0.2}}}}}},
                        {"box", {{"type", "cube"}, {"to_world", {step("scale", {0.3, 0.2, 0.4}), step("translate", {0.2, 0.4, 1})}}}}};
        members["rectangle"] = {{"type", "rectangle"}, {"to_world", Json::array({step("translate", {0.1, 0.2, -0.8})})}};
        members["disk"] = {{"type", "disk"}, {"to_world", {step("scale", {0.5, 0.8, 1}), step("translate", {-1.2, 0.2, 0.8})}}};
        if (round) {
            members["ball"] = {{"type", "sphere"}, {"center", {1.2, 0, 0.5}}, {"radius", 0.4}};
            members["tube"] = {{"type", "cylinder"}, {"p0", {-1, -1, 0}}, {"p1", {-1, 1, 0.3}}, {"radius", 0.2}};
        }
        Json scene = {{"type", "scene"},
                      {"sensor", {{"type", "perspective"}, {"to_world", {{{"type", "lookat"}, {"origin", {0.3, 0.2, 7}}, {"target", {0, 0, 0}}, {"up", {0, 1, 0}}}}}}},
                      {"light", {{"type", "point"}, {"position", {1, 2, 6}}, {"intensity", 30}}},
                      {"floor", {{"type", "rectangle"}, {"to_world", {step("scale", 6), step("translate", {0, 0, -3})}}}}};
        if (asInstance) {
            scene["group"] = members;
            scene["group"]["type"] = "shapegroup";
            scene["placed"] = {{"type", "instance"}, {"group", {{"type", "ref"}, {"id", "group"}}}, {"to_world", toWorld}};
        } else {
            for (auto& [name, member] : members.items()) {
                Json steps = member.contains("to_world") ? member["to_world"] : Json::array();
                for (const Json& next : toWorld) steps.push_back(next);
                member["to_world"] = steps;
                scene[name] = member;
            }
        }
        return SceneDescription::fromNode(JsonNode(scene), folder.path).build({{"width", 24}, {"height", 24}, {"rfilter", {{"type", "box"}}}});
    }
};

Vertex vertexOf(const Scene& scene, const Vec3f& origin, const Vec3f& direction, const Hit& hit) {
    Vertex v;
    scene.vertexAt(origin, direction, hit, v);
    return v;
}

struct Placing {
    Json toWorld;
    bool round;
};
const Placing kPlacings[] = {{kShift, true}, {kTurned, true}, {kStretched, false}, {kMirrored, false}, {kSheared, false}};

Image render(const Scene& scene, double spp) {
    const auto sampler = Registry<Sampler>::instance().create(JsonNode(Json{{"type", "path"}, {"max_depth", 5}}));
    RenderOptions options;
    options.budget.spp = spp;
    options.key = makeKey(3);
    options.threads = 1;
    return ulam::render(scene, *sampler, options).image;
}

}  // namespace

TEST_CASE("instances: rays meet the same points with the same geometry as when the shapes are written out") {
    for (const Placing& placing : kPlacings) {
        INFO(placing.toWorld.dump());
        const Twins twins(placing.toWorld, placing.round);
        REQUIRE(twins.instanced.shapes.size() == twins.flat.shapes.size());
        Random random(makeKey(4), 0, 0);
        std::vector<int> met(twins.flat.shapes.size());
        int differing = 0;
        constexpr int kRays = 20'000;
        for (int i = 0; i < kRays; ++i) {
            const Vec3f origin(6 * float(random()) - 3, 6 * float(random()) - 3, 6 * float(random()) - 2);
            const Vec3f direction = squareToSphere(random(), random());
            Hit a{}, b{};
            const bool hitA = twins.instanced.rays().intersect(origin, direction, a), hitB = twins.flat.rays().intersect(origin, direction, b);
            // At the outline of a shape, and where two of them cross, rounding decides.
            if (hitA != hitB || (hitA && (a.shape != b.shape || a.primitive != b.primitive))) {
                ++differing;
                continue;
            }
            if (!hitA) continue;
            ++met[a.shape];
            const Shape &s = twins.instanced.shapes[a.shape], &t = twins.flat.shapes[b.shape];
            const Vertex v = vertexOf(twins.instanced, origin, direction, a), w = vertexOf(twins.flat, origin, direction, b);
            REQUIRE(alike(v.position, w.position));
            REQUIRE(alike(v.position, origin + direction * a.distance, 1e-4f));
            REQUIRE(alike(v.normal, w.normal, 1e-4f));
            const auto* instance = std::get_if<MeshInstance>(&s.geometry);
            if (instance && !instance->mesh->normals.empty()) {
                // Interpolated in the group, then turned: n with Mᵀ n along the group's normal. (Written out, vertex normals
                // are unit before they are interpolated.)
                const auto& [i0, i1, i2] = instance->mesh->triangles[v.primitive];
                const auto& normals = instance->mesh->normals;
                const Vec3f own = normals[i0] * (1 - v.uv.x - v.uv.y) + normals[i1] * v.uv.x + normals[i2] * v.uv.y;
                const auto& m = instance->toWorld;
                REQUIRE(alike(normalize(Vec3f(dot(m[0], v.shadingNormal), dot(m[1], v.shadingNormal), dot(m[2], v.shadingNormal))), normalize(own), 1e-5f));
                REQUIRE(alike(v.shadingNormal, w.shadingNormal, placing.round ? 1e-4f : 0.2f));
            } else {
                REQUIRE(alike(v.shadingNormal, w.shadingNormal, 1e-4f));
            }
            const Vec2f uv = s.texcoord(v), expected = t.texcoord(w);
            REQUIRE((uv - expected).length() < 2e-3f);
            if (s.triangleMesh() && s.triangleMesh()->texcoords.empty()) continue;  // any frame
            REQUIRE(alike(s.tangents(v).u, t.tangents(w).u, 2e-2f));
            REQUIRE(alike(s.tangents(v).v, t.tangents(w).v, 2e-2f));
            const Vec3f to = v.position + v.normal * 0.01f - origin;
            if (dot(v.normal, direction) < 0) REQUIRE(twins.instanced.rays().occluded(origin, to) == twins.flat.rays().occluded(origin, to));
        }
        CHECK(differing < kRays / 1000);
        for (const int count : met) CHECK(count > 20);
    }
}

TEST_CASE("instances: mirrored normals stay outside, as Mitsuba 3 has them") {
    // From mitsuba.load_dict(…).ray_intersect(…): scale 1, 1, -2, then 30° around x.
    struct Case {
        const char* shape;
        Vec3f normal;
        Tangents tangents;
    };
    const Case cases[] = {{"rectangle", {0, -0.755929f, -0.654654f}, {{2, 0, 0}, {0, 1.73205f, -2}}},
                          {"cube", {0, 0.755929f, 0.654654f}, {{0, -1.73205f, 2}, {2, 0, 0}}},
                          {"disk", {0, -0.755929f, -0.654654f}, {{0.544705f, 0.726273f, -0.838628f}, {-2.90208f, 1.63242f, -1.88496f}}}};
    for (const Case& c : cases) {
        INFO(c.shape);
        // The steps of Mitsuba's example are applied last to first.
        const Scene scene = loadText(sceneWith(std::string(R"("g": {"type": "shapegroup", "m": {"type": ")") + c.shape + R"("}},
            "i": {"type": "instance", "g": {"type": "ref", "id": "g"},
                  "to_world": [{"type": "rotate", "axis": [1,0,0], "angle": 30}, {"type": "scale", "value": [1,1,-2]}]})"));
        const Vec3f origin(0.3f, 0.4f, 5), down(0, 0, -1);
        Hit hit{};
        REQUIRE(scene.rays().intersect(origin, down, hit));
        const Vertex v = vertexOf(scene, origin, down, hit);
        CHECK(alike(v.normal, c.normal, 1e-5f));
        CHECK(alike(v.shadingNormal, c.normal, 1e-5f));
        CHECK(alike(scene.shapes[0].tangents(v).u, c.tangents.u, 1e-4f));
        CHECK(alike(scene.shapes[0].tangents(v).v, c.tangents.v, 1e-4f));
    }
}

TEST_CASE("instances: areas, uniform points and the numbers of points") {
    for (const Json& toWorld : {kTurned, kStretched, kSheared}) {
        INFO(toWorld.dump());
        Twins twins(toWorld, false);
        for (uint32_t i = 0; i < twins.flat.shapes.size(); ++i) {
            Shape &s = twins.instanced.shapes[i], &t = twins.flat.shapes[i];
            INFO(s.id);
            s.emitter = t.emitter = 0;  // for a distribution over triangles
            s.prepare(), t.prepare();
            CHECK(s.area == Approx(t.area).epsilon(1e-5));
            for (const auto& corner : {t.bounds().min, t.bounds().max}) {
                const Imath::Box3f box = s.bounds();
                for (int axis = 0; axis < 3; ++axis) CHECK((corner[axis] > box.min[axis] - 1e-5f && corner[axis] < box.max[axis] + 1e-5f));
            }
            Random random(makeKey(6), 0, i);
            for (int k = 0; k < 500; ++k) {
                const double a = random(), b = random();
                const Vertex v = s.samplePoint(i, a, b), w = t.samplePoint(i, a, b);
                const Sample2 back = s.invertPoint(v);
                REQUIRE(alike(s.samplePoint(i, back.u, back.v).position, v.position, 1e-4f));
                // Where a number is next to a border between triangles they may differ.
                if (v.primitive != w.primitive) continue;
                REQUIRE(alike(v.position, w.position, 1e-3f));
                REQUIRE(alike(v.normal, w.normal, 1e-4f));
            }
        }
    }
}

TEST_CASE("instances: images are those of the shapes written out") {
    // Moved without turning: the same paths, but for a few that rounding sends elsewhere.
    const Twins moved(kShift, true);
    const Image a = render(moved.instanced, 16), b = render(moved.flat, 16);
    int differing = 0;
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        sum += b.pixels[i].y;
        differing += std::abs(a.pixels[i].y - b.pixels[i].y) > 1e-3f * b.pixels[i].y;
    }
    CHECK(sum > 1);
    CHECK(differing <= int(a.pixels.size()) / 50);
    // Turned: the mean of the image, by as many samples as leave 1 % of error.
    for (const Json& toWorld : {kTurned, kStretched}) {
        const Twins turned(toWorld, false);
        const auto mean = [](const Image& image) {
            double total = 0;
            for (const Rgb& p : image.pixels) total += p.x + p.y + p.z;
            return total / double(image.pixels.size());
        };
        CHECK(mean(render(turned.instanced, 64)) == Approx(mean(render(turned.flat, 64))).epsilon(0.01));
    }
}

TEST_CASE("instances: a thousand of them share one mesh") {
    std::string entries = R"("g": {"type": "shapegroup", "ball": {"type": "sphere", "radius": 0.2}, "box": {"type": "cube", "bsdf": {"type": "ref", "id": "grey"}}},
        "grey": {"type": "diffuse", "reflectance": 0.3})";
    for (int i = 0; i < 1000; ++i)
        entries += fmt::format(R"(, "i{}": {{"type": "instance", "g": {{"type": "ref", "id": "g"}},
            "to_world": [{{"type": "scale", "value": 0.3}}, {{"type": "translate", "value": [{}, {}, 0]}}]}})", i, i % 40, i / 40);
    const Scene scene = loadText(sceneWith(entries));
    REQUIRE(scene.shapes.size() == 2000);
    CHECK(scene.materials.size() == 2);
    for (const Shape& shape : scene.shapes)
        if (shape.triangleMesh()) CHECK(shape.triangleMesh() == scene.shapes[0].triangleMesh());
    CHECK(scene.shapes[2 * 777].id == "i777/box");
    CHECK(scene.shapes[2 * 777 + 1].id == "i777/ball");
    for (int i = 0; i < 1000; ++i) {
        Hit hit{};
        REQUIRE(scene.rays().intersect({float(i % 40) + 0.1f, float(i / 40) + 0.1f, 5}, {0, 0, -1}, hit));
        CHECK(hit.shape == uint32_t(2 * i));
        CHECK(hit.distance == Approx(4.7));
    }
}

TEST_CASE("instances: what cannot be is refused with its place") {
    const auto expect = [](const std::string& entries, const std::string& place, const std::string& reason) {
        const std::string message = errorOf(sceneWith(entries));
        INFO(message);
        CHECK(mentions(message, place));
        CHECK(mentions(message, reason));
    };
    const auto instance = [](const std::string& extra) { return R"(, "i": {"type": "instance", "of": {"type": "ref", "id": "g"})" + extra + "}"; };
    const std::string group = R"("g": {"type": "shapegroup", "ball": {"type": "sphere"}})";
    const std::string cubes = R"("g": {"type": "shapegroup", "box": {"type": "cube"}})";
    expect(R"("gg": {"type": "shapegroup", "ball": {"type": "sphere"}})" + instance(""), "/i/of/id", "unknown entry of the scene \"g\"");
    expect(R"("g": {"type": "sphere"})" + instance(""), "/i/of", "not \"sphere\"");
    expect(R"("g": {"type": "diffuse"})" + instance(""), "/i/of/id", "is no shape group");
    expect(group + R"(, "i": {"type": "instance"})", "/i", "needs a shape group");
    expect(group + R"(, "i": {"type": "instance", "a": {"type": "ref", "id": "g"}, "b": {"type": "ref", "id": "g"}})", "/i/b", "one shape group");
    expect(group + instance(R"(, "bsdf": {"type": "diffuse"})"), "/i/bsdf", "not \"diffuse\"");
    expect(group + instance(R"(, "radius": 2)"), "/i/radius", "");
    // No group in a group: so they form no cycles.
    expect(group + R"(, "h": {"type": "shapegroup", "i": {"type": "instance", "of": {"type": "ref", "id": "h"}}})", "/h/i", "no groups and no instances");
    expect(R"("h": {"type": "shapegroup", "i": {"type": "shapegroup"}})", "/h/i", "no groups and no instances");
    expect(R"("h": {"type": "shapegroup", "i": {"type": "ref", "id": "h"}})", "/h/i", "written in it");
    expect(group + R"(, "i": {"type": "instance", "of": {"type": "ref", "id": "j"}}, "j": {"type": "instance", "of": {"type": "ref", "id": "g"}})", "/i/of", "not \"instance\"");
    expect(R"("g": {"type": "shapegroup", "ball": {"type": "sphere", "e": {"type": "area"}}})", "/g/ball/e", "no emitter");
    expect(R"("g": {"type": "shapegroup", "to_world": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1], "ball": {"type": "sphere"}})", "/g/to_world", "");
    expect(R"("g": {"type": "shapegroup", "ball": {"type": "shpere"}})", "/g/ball", "sphere");
    // Transformations.
    expect(cubes + instance(R"(, "to_world": [{"type": "scale", "value": [1,0,1]}])"), "/i/to_world", "not invertible");
    expect(cubes + instance(R"(, "to_world": [1,1,0,0, 1,1.00000001,0,0, 0,0,1,0, 0,0,0,1])"), "/i/to_world", "too near");
    expect(cubes + instance(R"(, "to_world": [{"type": "scale", "value": 1e-10}])"), "/i/to_world", "1e-9");
    expect(cubes + instance(R"(, "to_world": [{"type": "scale", "value": 1e12}])"), "/i/to_world", "1e9");
    expect(cubes + instance(R"(, "to_world": [{"type": "scale", "value": 1e8}, {"type": "translate", "value": [1e15,0,0]}])"), "/i", "beyond 1e+15");
    expect(group + instance(R"(, "to_world": [{"type": "scale", "value": [1,2,1]}])"), "/i/to_world", "must stay round");
    expect(group + instance(R"(, "to_world": [{"type": "scale", "value": [1,1,2]}, {"type": "rotate", "axis": [1,1,0], "angle": 30}])"), "/i/to_world", "\"ball\"");
    if (!fullLevel()) return;
    // A group of a thousand shapes, five thousand times: two gigabytes.
    std::string many = R"("g": {"type": "shapegroup")";
    for (int i = 0; i < 1000; ++i) many += fmt::format(R"(, "s{}": {{"type": "sphere"}})", i);
    many += "}";
    for (int i = 0; i < 5000; ++i) many += fmt::format(R"(, "i{}": {{"type": "instance", "of": {{"type": "ref", "id": "g"}}}})", i);
    expect(many, "/i4194", "more than 4194304 shapes");
}

TEST_CASE("instances: groups alone are invisible, nested groups belong to their instance") {
    const Scene alone = loadText(sceneWith(R"("g": {"type": "shapegroup", "box": {"type": "cube"}})"));
    CHECK(alone.shapes.empty());
    Hit hit{};
    CHECK_FALSE(alone.rays().intersect({0, 0, 5}, {0, 0, -1}, hit));
    const Scene nested = loadText(sceneWith(R"("i": {"type": "instance", "g": {"type": "shapegroup", "box": {"type": "cube"}}, "to_world": [{"type": "translate", "value": [0,0,1]}]})"));
    REQUIRE(nested.rays().intersect({0, 0, 5}, {0, 0, -1}, hit));
    CHECK(hit.distance == Approx(3));
}

TEST_CASE("instances: Mitsuba's XML, the group after its instance") {
    const SceneFolder folder("instance_xml");
    folder.write("scene.xml", R"(<scene version="0.6.0"><sensor type="perspective"/><emitter type="point"/>
        <shape type="instance"><transform name="toWorld"><translate x="3"/></transform><ref id="trees"/></shape>
        <shape type="shapegroup" id="trees"><shape type="sphere"><bsdf type="diffuse"/></shape><shape type="cube"/><shape type="rectangle"/></shape></scene>)");
    const Scene scene = SceneDescription::fromFile(folder.path / "scene.xml").build();
    REQUIRE(scene.shapes.size() == 3);
    Hit hit{};
    REQUIRE(scene.rays().intersect({3.2f, 0.1f, 5}, {0, 0, -1}, hit));
    CHECK(hit.shape == 0);
    CHECK(hit.distance == Approx(4));
}
