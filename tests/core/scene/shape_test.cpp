#include "core/scene/shape.h"

#include "core/base/random.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

/// Two triangles of areas 1 and 3 in the plane z = 2.
Shape unequalTriangles() {
    Mesh mesh;
    mesh.positions = {{0, 0, 2}, {2, 0, 2}, {0, 1, 2}, {0, -3, 2}};
    mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
    Shape shape;
    shape.geometry = mesh;
    shape.emitter = 0;
    shape.prepare();
    return shape;
}

Shape sphere(bool flipped) {
    Shape shape;
    shape.geometry = Sphere{{1, 2, 3}, 0.5f};
    shape.flipNormals = flipped;
    shape.prepare();
    return shape;
}

/// One of each kind, none of them along the axes of the world.
std::vector<Shape> turnedShapes() {
    const Axes axes{normalize(Vec3f(1, 2, 2)), normalize(Vec3f(2, 1, -2)), normalize(Vec3f(2, -2, 1))};
    Axes mirrored = axes;
    mirrored[0] = -mirrored[0];
    Mesh mesh;
    mesh.positions = {{0, 0, 2}, {2, 0.5f, 2}, {0, 1, 1}, {0.5f, -3, 2}};
    mesh.texcoords = {{0.1f, 0.2f}, {0.7f, 0.1f}, {0.3f, 0.9f}, {0, 0.8f}};  // of opposite orientations
    mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
    std::vector<Shape> shapes(5);
    shapes[0].geometry = mesh;
    shapes[1].geometry = Sphere{{1, 2, 3}, 0.5f, axes};
    shapes[2].geometry = Sphere{{1, 2, 3}, 2, mirrored};
    shapes[3].geometry = Disk{{3, 2, 1}, {2, 0, 1}, {1, 1, 0}, normalize(cross({2, 0, 1}, {1, 1, 0}))};
    shapes[4].geometry = Cylinder{{3, 2, 1}, 0.5f, 3, axes};
    for (Shape& shape : shapes) {
        shape.emitter = 0;
        shape.prepare();
    }
    return shapes;
}

bool within(const Vec3f& a, const Vec3f& b, float tolerance = 1e-6f) {
    return length(a - b) <= tolerance;
}

}  // namespace

TEST_CASE("points of a mesh are uniform by area") {
    const Shape shape = unequalTriangles();
    CHECK(shape.area == Approx(4));
    Random random({1, 2}, 0, 0);
    constexpr int kPoints = 40000;
    int first = 0;
    Vec3d mean(0.0);
    for (int i = 0; i < kPoints; ++i) {
        const Vertex v = shape.samplePoint(7, random(), random());
        CHECK(v.shape == 7);
        first += v.primitive == 0;
        mean += Vec3d(v.position);
        REQUIRE(within(v.normal, {0, 0, 1}));
    }
    mean /= kPoints;
    // 5 standard deviations of a fraction, and of a mean of coordinates whose deviation is below 1.
    CHECK(std::abs(first / double(kPoints) - 0.25) < 5 * std::sqrt(0.25 * 0.75 / kPoints));
    const Vec3d expected = Vec3d(2.0 / 3, 1.0 / 3, 2) * 0.25 + Vec3d(2.0 / 3, -1, 2) * 0.75;
    CHECK((mean - expected).length() < 5 / std::sqrt(kPoints));
}

TEST_CASE("the numbers of a point give the point again") {
    Random random({3, 4}, 0, 0);
    for (const Shape& shape : {unequalTriangles(), sphere(false)})
        for (int i = 0; i < 1000; ++i) {
            const Vertex v = shape.samplePoint(0, random(), random());
            const Sample2 s = shape.invertPoint(v);
            const Vertex again = shape.samplePoint(0, s.u, s.v);
            REQUIRE(again.primitive == v.primitive);
            REQUIRE(within(again.position, v.position, 1e-5f));
        }
}

TEST_CASE("points of a sphere lie on it, uniformly, with normals on the chosen side") {
    const Shape outward = sphere(false), inward = sphere(true);
    CHECK(outward.area == Approx(kPi));
    Random random({5, 6}, 0, 0);
    Vec3d mean(0.0);
    constexpr int kPoints = 20000;
    for (int i = 0; i < kPoints; ++i) {
        const double u = random(), v = random();
        const Vertex a = outward.samplePoint(0, u, v), b = inward.samplePoint(0, u, v);
        REQUIRE(length(a.position - Vec3f(1, 2, 3)) == Approx(0.5));
        REQUIRE(within(a.normal, (a.position - Vec3f(1, 2, 3)) * 2.0f, 1e-5f));
        REQUIRE(within(b.normal, -a.normal));
        REQUIRE(within(a.shadingNormal, a.normal));
        mean += Vec3d(a.normal);
    }
    CHECK((mean / kPoints).length() < 5 / std::sqrt(kPoints));
}

TEST_CASE("shading normals are interpolated, geometric ones come from the winding") {
    Shape shape;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals = {normalize(Vec3f(0, 0, 1)), normalize(Vec3f(1, 0, 1)), normalize(Vec3f(0, 1, 1))};
    mesh.triangles = {{0, 1, 2}};
    shape.geometry = mesh;
    shape.prepare();
    Vertex v{};
    v.uv = {0.5f, 0.25f};
    shape.setNormals(v);
    CHECK(within(v.normal, {0, 0, 1}));
    CHECK(within(v.shadingNormal, normalize(mesh.normals[0] * 0.25f + mesh.normals[1] * 0.5f + mesh.normals[2] * 0.25f)));

    SECTION("normals that cancel out leave the geometric one") {
        mesh.normals = {{0, 0, 0}, {0, 0, 1}, {0, 0, -1}};
        shape.geometry = mesh;
        shape.prepare();
        v.uv = {0.5f, 0.5f};
        shape.setNormals(v);
        CHECK(within(v.shadingNormal, {0, 0, 1}));
    }
}

TEST_CASE("tangents are the derivatives of the place by the surface parameters") {
    Random random({7, 8}, 0, 0);
    for (const Shape& shape : turnedShapes()) {
        INFO("kind " << shape.geometry.index());
        int compared = 0;
        for (int i = 0; i < 300; ++i) {
            const double a = 0.9 * random(), b = 0.1 + 0.8 * random();
            const Vertex v = shape.samplePoint(0, a, b), w = shape.samplePoint(0, a + 1e-3 * random(), b + 1e-3 * random());
            const Vec2f step = shape.texcoord(w) - shape.texcoord(v);
            // Not across a seam, nor onto the next triangle, nor near poles and centres, where the parameters are bent much.
            const Vec2f at = shape.texcoord(v);
            if (v.primitive != w.primitive || step.length() > 0.02f || at.x < 0.1f || std::abs(at.y - 0.5f) > 0.4f) continue;
            const Tangents t = shape.tangents(v);
            const Vec3f moved = w.position - v.position;
            REQUIRE(length(t.u * step.x + t.v * step.y - moved) < 0.03f * length(moved) + 2e-6f);
            CHECK(within(shape.tangent(v), t.u));
            ++compared;
        }
        CHECK(compared > 100);
    }
}

TEST_CASE("tangents where the surface has no parameters of its own") {
    Vertex v{};
    SECTION("no texture coordinates: a frame of the normal") {
        const Shape shape = unequalTriangles();
        shape.setNormals(v);
        const Tangents t = shape.tangents(v);
        CHECK(within(cross(t.u, t.v), v.normal));
    }
    SECTION("texture coordinates all on one line: likewise") {
        Mesh mesh;
        mesh.positions = {{0, 0, 2}, {2, 0, 2}, {0, 1, 2}};
        mesh.texcoords = std::vector<Vec2f>{{0, 0}, {1, 1}, {2, 2}};
        mesh.triangles = {{0, 1, 2}};
        Shape shape;
        shape.geometry = mesh;
        shape.prepare();
        shape.setNormals(v);
        const Tangents t = shape.tangents(v);
        CHECK(within(cross(t.u, t.v), {0, 0, 1}));
    }
    SECTION("the poles of a sphere and the centre of a disk: along the limits") {
        v.position = {1, 2, 3.5f};
        Tangents t = sphere(false).tangents(v);
        CHECK(within(normalize(cross(t.u, t.v)), {0, 0, -1}));
        CHECK(length(t.v) == Approx(kPi / 2));
        Shape disk;
        disk.geometry = Disk{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        v.uv = {0, 0};
        t = disk.tangents(v);
        CHECK(within(t.u, {2, 0, 0}));
        CHECK(within(t.v, {0, 1, 0}));
    }
}
