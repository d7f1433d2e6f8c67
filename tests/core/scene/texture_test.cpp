// Textures and surface parameters, against values worked out by hand and, for the parametrisations, read off Mitsuba 3.9.

#include "core/scene/texture.h"

#include "core/image/image_io.h"
#include "core/path/local_bsdf.h"
#include "core/path/scattering.h"
#include "tests/core/scene/load_text.h"

using namespace ulam;

namespace {

/// Texel (i, j) holds ((4 j + i) + channel / 3) / 8.
Image numbered() {
    Image image(4, 2);
    for (int k = 0; k < 8; ++k) image.pixels[size_t(k)] = Rgb(float(k), float(k) + 1 / 3.0f, float(k) + 2 / 3.0f) / 8.0f;
    return image;
}

Vertex hitVertex(const Scene& scene, const Vec3f& origin, const Vec3f& direction) {
    Hit hit{};
    REQUIRE(scene.rays().intersect(origin, direction, hit));
    Vertex v;
    scene.vertexAt(origin, direction, hit, v);
    return v;
}

bool sameColour(const Vec3f& a, const Vec3f& b) { return length(a - b) < 2e-4f * std::max(1.0f, length(b)); }

}  // namespace

TEST_CASE("bitmap: row 0 at v = 0, texel centres at half numbers, wrapping and filters") {
    BitmapTexture::Parameters p;
    const BitmapTexture plain(p, {}, numbered());
    CHECK(plain.color({0.125f, 0.25f}).x == Approx(0));
    CHECK(plain.color({0.125f, 0.75f}).x == Approx(4 / 8.0));
    CHECK(plain.color({0.25f, 0.25f}).y == Approx((0.5 + 1 / 3.0) / 8));
    CHECK(plain.color({0.9f, 0.25f}).x == Approx(0.3 / 8 * 3 * 3).epsilon(1e-5));  // 0.9 of texel 3, 0.1 of texel 0
    CHECK(plain.color({-0.1f, 1.25f}).x == Approx(plain.color({0.9f, 0.25f}).x).epsilon(1e-5));
    p.wrapMode = "clamp";
    CHECK(BitmapTexture(p, {}, numbered()).color({1.7f, 0.25f}).x == Approx(3 / 8.0));
    p.wrapMode = "mirror";
    CHECK(BitmapTexture(p, {}, numbered()).color({1.125f, 0.25f}).x == Approx(3 / 8.0));
    CHECK(BitmapTexture(p, {}, numbered()).color({-0.375f, 0.25f}).x == Approx(1 / 8.0));
    p.filterType = "nearest";
    CHECK(BitmapTexture(p, {}, numbered()).color({0.49f, 0.4f}).x == Approx(1 / 8.0));
    const UvTransform turned{{0, 1, 0.25, 1, 0, 0.5}};
    CHECK(BitmapTexture({}, turned, numbered()).color({0.25f, 0.375f}).x == Approx(plain.color({0.625f, 0.75f}).x));
    CHECK(plain.value({0.125f, 0.25f}) == Approx(luminance(plain.color({0.125f, 0.25f}))));
    CHECK(plain.largest().z == Approx((7 + 2 / 3.0) / 8));
}

TEST_CASE("checkerboard: the square at the origin has color0") {
    CheckerboardTexture::Parameters p;
    const CheckerboardTexture board(p, {{2, 0, 0, 0, 1, 0}});
    CHECK(board.color({0.1f, 0.2f}).x == 0.4);
    CHECK(board.color({0.3f, 0.2f}).x == 0.2);
    CHECK(board.color({0.3f, 0.7f}).x == 0.4);
    CHECK(board.color({-0.1f, 0.2f}).x == 0.2);
}

TEST_CASE("surface parameters and tangents are Mitsuba's") {
    struct Case {
        const char* shape;
        Vec3f origin, direction;
        Vec2f uv;
        Tangents tangents;
    };
    // From mitsuba.load_dict(…).ray_intersect(…): uv, dp_du and dp_dv.
    const Case cases[] = {
        {R"("type": "sphere")", {0.3f, 0.4f, 5}, {0, 0, -1}, {0.147584f, 0.166667f}, {{-2.51327f, 1.88496f, 0}, {1.63242f, 2.17656f, -1.5708f}}},
        {R"("type": "sphere")", {-5, 0.3f, 0.6f}, {1, 0, 0}, {0.438821f, 0.295167f}, {{-1.88496f, -4.65973f, 0}, {-1.7474f, 0.706859f, -2.51327f}}},
        {R"("type": "sphere", "to_world": [{"type": "scale", "value": [-1,1,1]}])", {0.3f, 0.4f, 5}, {0, 0, -1}, {0.352416f, 0.166667f}, {{2.51327f, -1.88496f, 0}, {1.63242f, 2.17656f, -1.5708f}}},
        {R"("type": "disk")", {0.3f, 0.4f, 5}, {0, 0, -1}, {0.5f, 0.147584f}, {{0.6f, 0.8f, 0}, {-2.51327f, 1.88496f, 0}}},
        {R"("type": "cylinder")", {0.5f, -5, 0.25f}, {0, 1, 0}, {0.833333f, 0.25f}, {{5.4414f, 3.14159f, 0}, {0, 0, 1}}},
        {R"("type": "cylinder", "p0": [0,0,1], "p1": [1,1,1], "radius": 0.3)", {0.5f, 0.5f, 5}, {0, 0, -1}, {0.625f, 0.5f}, {{1.33286f, -1.33286f, 0}, {1, 1, 0}}},
        {R"("type": "rectangle")", {0.3f, 0.4f, 5}, {0, 0, -1}, {0.65f, 0.7f}, {{2, 0, 0}, {0, 2, 0}}},
        {R"("type": "cube")", {0.3f, 0.4f, 5}, {0, 0, -1}, {0.7f, 0.65f}, {{0, 2, 0}, {2, 0, 0}}},
    };
    for (const Case& c : cases) {
        INFO(c.shape);
        const Scene scene = loadText(sceneWith("\"s\": {" + std::string(c.shape) + "}"));
        const Vertex v = hitVertex(scene, c.origin, c.direction);
        const Vec2f uv = scene.shapes[0].texcoord(v);
        CHECK((uv - c.uv).length() < 1e-5f);
        CHECK(sameColour(scene.shapes[0].tangents(v).u, c.tangents.u));
        CHECK(sameColour(scene.shapes[0].tangents(v).v, c.tangents.v));
    }
}

TEST_CASE("disk and cylinder: hits, normals, areas, uniform points that lie on them") {
    const Scene scene = loadText(sceneWith(
        R"("d": {"type": "disk", "to_world": [{"type": "scale", "value": [2,1,1]}, {"type": "rotate", "axis": [0,0,1], "angle": 30}]},
           "c": {"type": "cylinder", "p0": [5,0,0], "p1": [5,3,0], "radius": 0.5, "flip_normals": true})"));
    CHECK(scene.shapes[0].area == Approx(2 * kPi));
    CHECK(scene.shapes[1].area == Approx(3 * kPi));
    CHECK(sameColour(hitVertex(scene, {1.2f, 0.4f, 5}, {0, 0, -1}).normal, {0, 0, 1}));
    CHECK(sameColour(hitVertex(scene, {1.2f, 0.4f, -5}, {0, 0, 1}).normal, {0, 0, 1}));
    const Vertex outside = hitVertex(scene, {5, 1, 4}, {0, 0, -1});
    CHECK(sameColour(outside.position, {5, 1, 0.5f}));
    CHECK(sameColour(outside.normal, {0, 0, -1}));
    const Vertex inside = hitVertex(scene, {5, 10, 0.2f}, normalize(Vec3f(0, -8, -0.7f)));
    CHECK(inside.position.z == Approx(-0.5).epsilon(1e-4));
    Hit hit{};
    CHECK_FALSE(scene.rays().intersect({5, 3.1f, 4}, {0, 0, -1}, hit));
    CHECK_FALSE(scene.rays().intersect({-1.2f, 0.7f, 5}, {0, 0, -1}, hit));
    CHECK(scene.rays().occluded({5, 1, 4}, {0, 0, -8}));
    CHECK_FALSE(scene.rays().occluded({5, 1, 4}, {0, 0, -3.4f}));

    Random random(makeKey(3), 0, 0);
    for (uint32_t s = 0; s < 2; ++s) {
        const Shape& shape = scene.shapes[s];
        Vec3d mean(0.0);
        constexpr int kPoints = 20'000;
        for (int i = 0; i < kPoints; ++i) {
            const double a = random(), b = random();
            const Vertex v = shape.samplePoint(s, a, b);
            const Vertex met = hitVertex(scene, v.position + v.normal * 0.1f, -v.normal);
            REQUIRE(met.shape == s);
            REQUIRE(length(met.position - v.position) < 1e-4f);
            const Sample2 again = shape.invertPoint(v);
            REQUIRE(length(shape.samplePoint(s, again.u, again.v).position - v.position) < 1e-4f);
            mean += Vec3d(v.position) / kPoints;
        }
        CHECK((mean - (s == 0 ? Vec3d(0.0) : Vec3d(5, 1.5, 0))).length() < 0.04);
    }
}

TEST_CASE("textures reach BSDFs, masks and lights") {
    const SceneFolder folder("texture_test");
    writeExr((folder.path / "n.exr").string(), numbered());
    const Scene scene = loadText(sceneWith(
        R"("board": {"type": "checkerboard", "color0": 0.25, "color1": 0.75},
           "r": {"type": "rectangle",
                 "m": {"type": "mask", "opacity": {"type": "ref", "id": "board"},
                       "b": {"type": "twosided", "front": {"type": "diffuse", "reflectance": {"type": "bitmap", "filename": "n.exr"}}}},
                 "e": {"type": "area", "radiance": {"type": "bitmap", "filename": "n.exr", "filter_type": "nearest"}}})"), folder.path);
    const Vertex v = hitVertex(scene, {-0.75f, -0.5f, 5}, {0, 0, -1});  // uv = (0.125, 0.25)
    const Vertex w = hitVertex(scene, {0.75f, -0.5f, 5}, {0, 0, -1});   // uv = (0.875, 0.25)
    const auto reflectance = [&](const Vertex& x, float side) {
        return withBsdf(scene, x, side, [](const auto& bsdf, const LocalFrame&) { return bsdf.eval(Vec3d(0, 0, 1), Vec3d(0, 0, 1), Lobe::Smooth).z * kPi; });
    };
    for (const float side : {1.0f, -1.0f}) {
        CHECK(reflectance(v, side) == Approx(0.25 * (2 / 3.0) / 8).epsilon(1e-5));
        CHECK(reflectance(w, side) == Approx(0.75 * (3 + 2 / 3.0) / 8).epsilon(1e-5));
    }
    CHECK(scatter(scene, v, Lobe::Null, {0, 0, 1}, {0, 0, -1}).f.x == Approx(0.75));
    CHECK(smoothShare(scene, w, {0, 0, 1}) == Approx(0.75));
    const AreaEmitter& light = std::get<AreaEmitter>(scene.emitters[scene.shapes[0].emitter]);
    CHECK(light.radiance(scene.emission(0), w, {0, 0, 1}).x == Approx(3 / 8.0));
    CHECK(light.emitted.x == Approx(3.5 / 8).epsilon(1e-3));
}
