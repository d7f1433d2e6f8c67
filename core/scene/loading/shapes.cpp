#include "core/scene/loading/shapes.h"

#include "core/scene/loading/geometry.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"
#include "core/scene/mesh_io.h"

namespace ulam {
namespace {

struct PlacementParameters {
    JsonNode toWorld;
    bool flipNormals = false;
    template <class V>
    void describe(V& v) {
        v("to_world", toWorld, {.help = "object to world: a matrix or a list of steps"});
        v("flip_normals", flipNormals, {.help = "turn the normals around"});
    }
};

struct SphereParameters : PlacementParameters {
    JsonNode center;
    double radius = 1;
    template <class V>
    void describe(V& v) {
        v("center", center, {.help = "centre [x,y,z], before to_world; default the origin"});
        v("radius", radius, {.help = "radius, before to_world", .min = 0, .minExclusive = true});
        PlacementParameters::describe(v);
    }
};

struct FileParameters : PlacementParameters {
    JsonNode filename;
    bool faceNormals = false;
    template <class V>
    void describe(V& v) {
        v("filename", filename, {.help = "file, relative to the scene's folder and inside it"});
        v("face_normals", faceNormals,
          {.help = "flat shading; else normals of the file, or smooth ones if it has none"});
        PlacementParameters::describe(v);
    }
};

struct ObjParameters : FileParameters {
    bool flipTexCoords = true;
    template <class V>
    void describe(V& v) {
        FileParameters::describe(v);
        v("flip_tex_coords", flipTexCoords, {.help = "turn the vertical texture coordinate around"});
    }
};

struct MeshParameters {
    JsonNode positions, triangles, normals;
    template <class V>
    void describe(V& v) {
        v("positions", positions, {.help = "vertices x, y, z one after another, in world space"});
        v("triangles", triangles,
          {.help = "three vertex numbers a triangle, counted from 0, counter-clockwise seen from outside"});
        v("normals", normals, {.help = "x, y, z a vertex; none: flat shading"});
    }
};

MeshPlacement placementOf(const PlacementParameters& p) {
    return {parseTransform(p.toWorld), p.flipNormals};
}

/// Corners in order around a face; two triangles.
void addQuad(Mesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
    const auto first = uint32_t(mesh.positions.size());
    const Vec3f normal = normalize(cross(b - a, c - a));
    for (const Vec3f& corner : {a, b, c, d}) {
        mesh.positions.push_back(corner);
        mesh.normals.push_back(normal);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

/// A mesh whose normals are those of its faces: they fix the side under a mirroring and are not needed afterwards.
Shape placeFlat(Mesh mesh, const JsonNode& node, LoadContext& context) {
    Shape shape;
    Mesh placed = placeMesh(std::move(mesh), placementOf(parsePlugin<PlacementParameters>(node)), node, context);
    placed.normals.clear();
    shape.geometry = std::move(placed);
    return shape;
}

Shape readRectangle(const JsonNode& node, LoadContext& context) {
    Mesh mesh;
    addQuad(mesh, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    return placeFlat(std::move(mesh), node, context);
}

Shape readCube(const JsonNode& node, LoadContext& context) {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            Vec3f n(0.0f), s(0.0f), t(0.0f);
            n[axis] = side, s[(axis + 1) % 3] = side, t[(axis + 2) % 3] = 1;  // s × t = n
            addQuad(mesh, n - s - t, n + s - t, n + s + t, n - s + t);
        }
    return placeFlat(std::move(mesh), node, context);
}

Shape readSphere(const JsonNode& node, LoadContext&) {
    const auto p = parsePlugin<SphereParameters>(node);
    const Matrix4 m = parseTransform(p.toWorld);
    const auto scale = uniformScale(m);
    if (!scale)
        p.toWorld.fail("a sphere's to_world must keep it a sphere: rotations, translations and uniform scale only");
    Vec3d center(0.0);
    m.multVecMatrix(p.center.isNull() ? Vec3d(0.0) : parseVector(p.center), center);
    const double radius = p.radius * std::abs(*scale);
    if (!(center.length() + radius <= kLargestCoordinate && radius > 1 / kLargestCoordinate))
        node.fail(fmt::format("the sphere's place or radius is beyond {0:g}, or the radius below 1/{0:g}",
                              kLargestCoordinate));
    const Sphere sphere{Vec3f(center), float(radius)};
    Shape shape;
    shape.geometry = sphere;
    shape.flipNormals = p.flipNormals != (*scale < 0);
    return shape;
}

Shape placeFromFile(Mesh mesh, const FileParameters& p, const JsonNode& node, LoadContext& context) {
    MeshPlacement placement = placementOf(p);
    placement.normals = p.faceNormals ? MeshPlacement::Normals::Flat : MeshPlacement::Normals::Smooth;
    Shape shape;
    shape.geometry = placeMesh(std::move(mesh), placement, node, context);
    return shape;
}

Shape readObjShape(const JsonNode& node, LoadContext& context) {
    const auto p = parsePlugin<ObjParameters>(node);
    const JsonNode filename = node.at("filename");
    return placeFromFile(readObj(context.read(filename), filename.string(), p.flipTexCoords), p, node, context);
}

Shape readPlyShape(const JsonNode& node, LoadContext& context) {
    const auto p = parsePlugin<FileParameters>(node);
    const JsonNode filename = node.at("filename");
    return placeFromFile(readPly(context.read(filename), filename.string()), p, node, context);
}

std::vector<Vec3f> parsePoints(const JsonNode& node) {
    const std::vector<double> numbers = node.numbers();
    if (numbers.size() % 3 != 0) node.expected("three numbers a vertex");
    std::vector<Vec3f> points;
    for (size_t i = 0; i < numbers.size(); i += 3)
        points.emplace_back(float(numbers[i]), float(numbers[i + 1]), float(numbers[i + 2]));
    return points;
}

Shape readInlineMesh(const JsonNode& node, LoadContext& context) {
    const auto p = parsePlugin<MeshParameters>(node);
    Mesh mesh;
    mesh.positions = parsePoints(node.at("positions"));
    if (!p.normals.isNull()) mesh.normals = parsePoints(p.normals);
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size())
        p.normals.expected(fmt::format("{} normals, one a vertex", mesh.positions.size()));
    const JsonNode triangles = node.at("triangles");
    const std::vector<double> indices = triangles.numbers();
    if (indices.size() % 3 != 0) triangles.expected("three vertex numbers a triangle");
    const auto index = [&](size_t i) {
        if (!(indices[i] >= 0 && indices[i] < double(mesh.positions.size()) && indices[i] == std::floor(indices[i])))
            triangles[i].expected(fmt::format("a vertex number below {}", mesh.positions.size()));
        return uint32_t(indices[i]);
    };
    for (size_t i = 0; i < indices.size(); i += 3) mesh.triangles.push_back({index(i), index(i + 1), index(i + 2)});
    Shape shape;
    shape.geometry = placeMesh(std::move(mesh), {}, node, context);
    return shape;
}

const PluginTable<Shape(const JsonNode&, LoadContext&)>& table() {
    static const PluginTable<Shape(const JsonNode&, LoadContext&)> plugins(
        "shape",
        {
            {{"cube", "box [-1,1] in x, y and z, normals outwards", parameterInfo<PlacementParameters>()}, readCube},
            {{"mesh", "triangles in the dictionary itself, as generators write them", parameterInfo<MeshParameters>()},
             readInlineMesh},
            {{"obj", "triangle mesh from a Wavefront OBJ file", parameterInfo<ObjParameters>()}, readObjShape},
            {{"ply", "triangle mesh from a Stanford PLY file", parameterInfo<FileParameters>()}, readPlyShape},
            {{"rectangle", "square [-1,1] in x and y at z = 0, normal +z", parameterInfo<PlacementParameters>()},
             readRectangle},
            {{"sphere", "sphere, normals outwards", parameterInfo<SphereParameters>()}, readSphere},
        });
    return plugins;
}

}  // namespace

std::vector<PluginInfo> shapePlugins() {
    return table().infos();
}

Shape readShape(const JsonNode& node, LoadContext& context) {
    return table().find(node).read(node, context);
}

}  // namespace ulam
