#include "core/scene/loading/shapes.h"

#include "core/scene/loading/geometry.h"
#include "core/scene/loading/groups.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"
#include "core/scene/mesh_io.h"

#include <array>

namespace ulam {
namespace {

struct PlacementParameters {
    JsonNode toWorld;
    bool flipNormals = false;
    template <class V>
    void describe(V& v) {
        v("to_world", toWorld,
          {.help = "object to world: a matrix or a list of steps",
           .example =
               R"([{"type": "rotate", "axis": [0, 1, 0], "angle": 30}, {"type": "translate", "value": [0, 1, 0]}])"});
        v("flip_normals", flipNormals, {.help = "turn the normals around"});
    }
};

struct SphereParameters : PlacementParameters {
    JsonNode center;
    double radius = 1;
    template <class V>
    void describe(V& v) {
        v("center", center, {.help = "centre [x,y,z], before to_world; default the origin", .example = "[0, 1, 0]"});
        v("radius", radius, {.help = "radius, before to_world", .min = 0, .minExclusive = true});
        PlacementParameters::describe(v);
    }
};

struct CylinderParameters : PlacementParameters {
    JsonNode p0, p1;
    double radius = 1;
    template <class V>
    void describe(V& v) {
        v("p0", p0,
          {.help = "middle of one end [x,y,z], before to_world; default the origin", .example = "[0, -1, 0]"});
        v("p1", p1, {.help = "middle of the other end; default [0,0,1]", .example = "[0, 1, 0]"});
        v("radius", radius, {.help = "radius, before to_world", .min = 0, .minExclusive = true});
        PlacementParameters::describe(v);
    }
};

struct FileParameters : PlacementParameters {
    JsonNode filename;
    bool faceNormals = false;
    template <class V>
    void describe(V& v) {
        v("filename", filename,
          {.help = "file, relative to the scene's folder and inside it", .example = R"("meshes/bunny.ply")"});
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

struct SerializedParameters : FileParameters {
    int shapeIndex = 0;
    template <class V>
    void describe(V& v) {
        FileParameters::describe(v);
        v("shape_index", shapeIndex, {.help = "which of the file's meshes, counted from 0", .min = 0, .max = 1e9});
    }
};

struct MeshParameters {
    JsonNode positions, triangles, normals, texcoords;
    template <class V>
    void describe(V& v) {
        v("positions", positions,
          {.help = "vertices x, y, z one after another, in world space", .example = "[0, 0, 0, 1, 0, 0, 0, 1, 0]"});
        v("triangles", triangles,
          {.help = "three vertex numbers a triangle, counted from 0, counter-clockwise seen from outside",
           .example = "[0, 1, 2]"});
        v("normals", normals,
          {.help = "x, y, z a vertex; none: flat shading", .example = "[0, 0, 1, 0, 0, 1, 0, 0, 1]"});
        v("texcoords", texcoords,
          {.help = "u, v a vertex; none: barycentric coordinates", .example = "[0, 0, 1, 0, 0, 1]"});
    }
};

MeshPlacement placementOf(const PlacementParameters& p) {
    return {parseTransform(p.toWorld), p.flipNormals};
}

/// Corners in order around a face, with their texture coordinates; two triangles.
void addQuad(Mesh& mesh, const std::array<Vec3f, 4>& corners, const std::array<Vec2f, 4>& texcoords) {
    const auto first = uint32_t(mesh.positions.size());
    const Vec3f normal = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
    for (size_t i = 0; i < 4; ++i) {
        mesh.positions.push_back(corners[i]);
        mesh.normals.push_back(normal);
        mesh.texcoords.push_back(texcoords[i]);
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
    addQuad(mesh, {Vec3f(-1, -1, 0), Vec3f(1, -1, 0), Vec3f(1, 1, 0), Vec3f(-1, 1, 0)},
            {Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1)});
    return placeFlat(std::move(mesh), node, context);
}

Shape readCube(const JsonNode& node, LoadContext& context) {
    Mesh mesh;
    // The direction of growing u on each face, as Mitsuba 3 has it; v grows along u × n.
    const std::array<std::array<Vec3f, 2>, 6> faces{{{Vec3f(0, -1, 0), Vec3f(0, 0, 1)},
                                                     {Vec3f(0, 1, 0), Vec3f(-1, 0, 0)},
                                                     {Vec3f(1, 0, 0), Vec3f(0, 1, 0)},
                                                     {Vec3f(0, 0, 1), Vec3f(0, 1, 0)},
                                                     {Vec3f(-1, 0, 0), Vec3f(0, 1, 0)},
                                                     {Vec3f(0, 0, -1), Vec3f(0, -1, 0)}}};
    for (const auto& [n, s] : faces) {
        const Vec3f t = cross(s, n);
        addQuad(mesh, {n - s + t, n + s + t, n + s - t, n - s - t}, {Vec2f(0, 1), Vec2f(1, 1), Vec2f(1, 0), Vec2f(0, 0)});
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
    Shape shape;
    shape.geometry = Sphere{Vec3f(center), float(radius), axesOf(m)};
    shape.flipNormals = p.flipNormals != (*scale < 0);
    return shape;
}

Shape readDisk(const JsonNode& node, LoadContext&) {
    const auto p = parsePlugin<PlacementParameters>(node);
    const Matrix4 m = parseTransform(p.toWorld);
    Vec3d center, x, y, normal;
    m.multVecMatrix(Vec3d(0.0), center);
    m.multDirMatrix(Vec3d(1, 0, 0), x);
    m.multDirMatrix(Vec3d(0, 1, 0), y);
    m.inverse().transposed().multDirMatrix(Vec3d(0, 0, p.flipNormals ? -1 : 1), normal);
    if (!(center.length() + x.length() + y.length() <= kLargestCoordinate))
        node.fail(fmt::format("the disk reaches beyond {:g}", kLargestCoordinate));
    Shape shape;
    shape.geometry = Disk{Vec3f(center), Vec3f(x), Vec3f(y), Vec3f(normal.normalized())};
    return shape;
}

Shape readCylinder(const JsonNode& node, LoadContext&) {
    const auto p = parsePlugin<CylinderParameters>(node);
    const Matrix4 m = parseTransform(p.toWorld);
    const auto scale = uniformScale(m);
    if (!scale) p.toWorld.fail("a cylinder's to_world must keep it round: rotations, translations and uniform scale only");
    const Vec3d p0 = p.p0.isNull() ? Vec3d(0.0) : parseVector(p.p0), p1 = p.p1.isNull() ? Vec3d(0, 0, 1) : parseVector(p.p1);
    const double length = (p1 - p0).length() * std::abs(*scale), radius = p.radius * std::abs(*scale);
    if (!(length > 0)) node.fail("the cylinder has no length: p0 and p1 are the same point");
    Vec3d base;
    m.multVecMatrix(p0, base);
    if (!(base.length() + length + radius <= kLargestCoordinate && radius > 1 / kLargestCoordinate))
        node.fail(fmt::format("the cylinder reaches beyond {0:g}, or its radius is below 1/{0:g}", kLargestCoordinate));
    const Frame own(Vec3f((p1 - p0).normalized()));
    Axes axes;
    for (size_t i = 0; i < 3; ++i) {
        Vec3d axis;
        m.multDirMatrix(Vec3d(i == 0 ? own.s : i == 1 ? own.t : own.n), axis);
        axes[i] = Vec3f(axis.normalized());
    }
    Shape shape;
    shape.geometry = Cylinder{Vec3f(base), float(radius), float(length), axes};
    shape.flipNormals = p.flipNormals;
    return shape;
}

/// `read` makes a mesh of the file's bytes, which are let go before the mesh is worked on.
template <class Read>
Shape placeFromFile(const Read& read, FileParameters& p, const JsonNode& node, LoadContext& context) {
    const JsonNode filename = node.at("filename");
    Mesh mesh = read(context.read(filename), filename.string());
    MeshPlacement placement = placementOf(p);
    placement.normals = p.faceNormals ? MeshPlacement::Normals::Flat : MeshPlacement::Normals::Smooth;
    Shape shape;
    shape.geometry = placeMesh(std::move(mesh), placement, node, context);
    return shape;
}

Shape readObjShape(const JsonNode& node, LoadContext& context) {
    auto p = parsePlugin<ObjParameters>(node);
    const auto read = [&](const std::string& bytes, const std::string& name) { return readObj(bytes, name, p.flipTexCoords); };
    return placeFromFile(read, p, node, context);
}

Shape readPlyShape(const JsonNode& node, LoadContext& context) {
    auto p = parsePlugin<FileParameters>(node);
    return placeFromFile(readPly, p, node, context);
}

Shape readSerializedShape(const JsonNode& node, LoadContext& context) {
    auto p = parsePlugin<SerializedParameters>(node);
    const auto read = [&](const std::string& bytes, const std::string& name) {
        SerializedMesh serialized = readSerialized(bytes, name, p.shapeIndex);
        p.faceNormals |= serialized.faceNormals;
        return std::move(serialized.mesh);
    };
    return placeFromFile(read, p, node, context);
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
    if (!p.texcoords.isNull()) {
        const std::vector<double> numbers = p.texcoords.numbers(2 * mesh.positions.size());
        for (size_t i = 0; i < numbers.size(); i += 2) mesh.texcoords.emplace_back(float(numbers[i]), float(numbers[i + 1]));
    }
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

const PluginTable<Shape(const JsonNode&, LoadContext&)>& shapeTable() {
    static const PluginTable<Shape(const JsonNode&, LoadContext&)> plugins(
        "shape",
        {
            {{"cube", "box [-1,1] in x, y and z, normals outwards", parameterInfo<PlacementParameters>()}, readCube},
            {{"cylinder", "open cylinder, normals outwards", parameterInfo<CylinderParameters>()}, readCylinder},
            {{"disk", "disc of radius 1 in x and y at z = 0, normal +z", parameterInfo<PlacementParameters>()}, readDisk},
            {{"mesh", "triangles in the dictionary itself, as generators write them", parameterInfo<MeshParameters>()},
             readInlineMesh},
            {{"obj", "triangle mesh from a Wavefront OBJ file", parameterInfo<ObjParameters>()}, readObjShape},
            {{"ply", "triangle mesh from a Stanford PLY file", parameterInfo<FileParameters>()}, readPlyShape},
            {{"rectangle", "square [-1,1] in x and y at z = 0, normal +z", parameterInfo<PlacementParameters>()},
             readRectangle},
            {{"serialized", "triangle mesh from a .serialized file of Mitsuba", parameterInfo<SerializedParameters>()}, readSerializedShape},
            {{"sphere", "sphere, normals outwards", parameterInfo<SphereParameters>()}, readSphere},
        });
    return plugins;
}

}  // namespace

std::vector<PluginInfo> shapePlugins() {
    std::vector<PluginInfo> all = shapeTable().infos();
    for (PluginInfo& plugin : groupPlugins()) all.push_back(std::move(plugin));
    return all;
}

const std::vector<ParameterInfo>& shapeParameters(const JsonNode& node) {
    static const std::vector<PluginInfo> all = shapePlugins();
    for (const PluginInfo& plugin : all)
        if (plugin.name == pluginName(node)) return plugin.parameters;
    unknownPlugin(node, "shape", all);
}

Shape readShape(const JsonNode& node, LoadContext& context) {
    return shapeTable().find(node).read(node, context);
}

}  // namespace ulam
