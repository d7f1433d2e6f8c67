#include "core/scene/pbrt/shapes.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>

#include "core/config/suggest.h"
#include "core/scene/loading/scene_file.h"
#include "core/scene/loading/transform.h"
#include "core/scene/pbrt/subdivision.h"

namespace ulam::pbrt {
namespace {

constexpr int kFinestSubdivision = 12;
constexpr double kMostTriangles = 2e6;      // of a subdivided mesh
constexpr double kMostTrianglesOfAll = 2e7;  // of all subdivided meshes: a line of text makes one

void needsFull(const Parameters& p, std::string_view name, double value, double full) {
    if (std::abs(value - full) > 1e-6 * std::max(1.0, std::abs(full)))
        refuse(p.place(),
               fmt::format("{} of {} is {:g}: parts of shapes are not supported", inQuotes(name), p.owner(), value));
}

double positive(const Parameters& p, std::string_view name, double otherwise) {
    const double value = p.number(name, otherwise);
    if (!(value > 0)) refuse(p.place(), fmt::format("{} of {} must be above 0", inQuotes(name), p.owner()));
    return value;
}

Matrix4 translation(const Vec3d& v) {
    Matrix4 m;
    return m.setTranslation(v);
}

void readSphere(const Parameters& p, ShapeRecord& shape, Dictionary&) {
    const double radius = positive(p, "radius", 1);
    if (p.number("zmin", -radius) > -radius) needsFull(p, "zmin", p.number("zmin", -radius), -radius);
    if (p.number("zmax", radius) < radius) needsFull(p, "zmax", p.number("zmax", radius), radius);
    needsFull(p, "phimax", p.number("phimax", 360), 360);
    shape.plugin = {{"type", "sphere"}, {"radius", radius}};
    shape.parametrization = Parametrization::Sphere;
}

void readDisk(const Parameters& p, ShapeRecord& shape, Dictionary&) {
    const double radius = positive(p, "radius", 1);
    needsFull(p, "innerradius", p.number("innerradius", 0), 0);
    needsFull(p, "phimax", p.number("phimax", 360), 360);
    Matrix4 scale;
    scale.setScale(Vec3d(radius, radius, 1));
    shape.plugin = {{"type", "disk"}};
    shape.toWorld = scale * translation({0, 0, p.number("height", 0)}) * shape.toWorld;
    shape.parametrization = Parametrization::Disk;
}

void readCylinder(const Parameters& p, ShapeRecord& shape, Dictionary&) {
    const double low = p.number("zmin", -1), high = p.number("zmax", 1);
    needsFull(p, "phimax", p.number("phimax", 360), 360);
    shape.plugin = {{"type", "cylinder"},
                    {"p0", {0, 0, std::min(low, high)}},
                    {"p1", {0, 0, std::max(low, high)}},
                    {"radius", positive(p, "radius", 1)}};
}

/// Vertex numbers; without them three vertices are a triangle.
std::vector<double> indicesOf(const Parameters& p, size_t vertices) {
    std::vector<double> indices;
    if (const Parameter* given = p.find("indices", {"integer"}))
        indices = given->numbers;
    else if (vertices == 3)
        indices = {0, 1, 2};
    else
        refuse(p.place(), fmt::format("{} of {} vertices has no \"indices\"", p.owner(), vertices));
    if (indices.empty() || indices.size() % 3 != 0)
        refuse(p.place(), fmt::format("the indices of {} are not three a triangle", p.owner()));
    for (const double index : indices)
        if (!(index >= 0 && index < double(vertices)))
            refuse(p.place(),
                   fmt::format("{} names vertex {}, but there are {} (counted from 0)", p.owner(), index, vertices));
    return indices;
}

void readTriangles(const Parameters& p, ShapeRecord& shape, Dictionary&) {
    shape.plugin = {{"type", "mesh"}};
    shape.positions = p.needed("P", {"point3"}).numbers;
    const size_t vertices = shape.positions.size() / 3;
    shape.indices = indicesOf(p, vertices);
    const auto perVertex = [&](std::string_view name, std::string_view type, size_t width) {
        const Parameter* given = p.find(name, {type});
        if (!given) return std::vector<double>();
        if (given->numbers.size() != width * vertices)
            refuse(given->place, fmt::format("{} of {} has {} values for {} vertices", inQuotes(name), p.owner(),
                                             given->numbers.size() / width, vertices));
        return given->numbers;
    };
    shape.normals = perVertex("N", "normal", 3);
    shape.texcoords = perVertex("uv", "point2", 2);
    perVertex("S", "vector3", 3);  // tangents: those along u are used
    p.ignore({"faceIndices"});
}

void readSubdivision(const Parameters& p, ShapeRecord& shape, Dictionary& dictionary) {
    const std::vector<double> control = p.needed("P", {"point3"}).numbers;
    const std::vector<double> indices = indicesOf(p, control.size() / 3);
    const int levels = p.integer("levels", 3);
    p.text("scheme", "loop");
    const std::size_t faces = indices.size() / 3;
    const double count = double(faces) * std::pow(4, levels);
    if (levels < 0 || levels > kFinestSubdivision || count > kMostTriangles)
        refuse(p.place(), fmt::format("{} levels of {} are too many: at most {}, and {:g} triangles", levels, p.owner(),
                                      kFinestSubdivision, kMostTriangles));
    if ((dictionary.subdivided += count) > kMostTrianglesOfAll)
        refuse(p.place(), fmt::format("all subdivided meshes together have more than {:g} triangles", kMostTrianglesOfAll));
    std::vector<Vec3d> positions;
    for (size_t i = 0; i < control.size(); i += 3) positions.emplace_back(control[i], control[i + 1], control[i + 2]);
    std::vector<std::array<int, 3>> triangles;
    for (size_t i = 0; i < indices.size(); i += 3)
        triangles.push_back({int(indices[i]), int(indices[i + 1]), int(indices[i + 2])});
    try {
        const SubdivisionMesh mesh = subdivide(std::move(positions), std::move(triangles), levels);
        shape.plugin = {{"type", "mesh"}};
        for (const Vec3d& v : mesh.positions) shape.positions.insert(shape.positions.end(), {v.x, v.y, v.z});
        for (const Vec3d& n : mesh.normals) shape.normals.insert(shape.normals.end(), {n.x, n.y, n.z});
        for (const auto& t : mesh.triangles)
            shape.indices.insert(shape.indices.end(), {double(t[0]), double(t[1]), double(t[2])});
    } catch (const NoSurface& error) {
        refuse(p.place(), fmt::format("{} has no limit surface: {}", p.owner(), error.what()));
    }
}

/// Names of the properties that a PLY file's header announces.
std::vector<std::string> plyProperties(const std::filesystem::path& file) {
    constexpr size_t kLongestHeader = 1 << 16;
    std::string header(kLongestHeader, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(header.data(), std::streamsize(header.size()));
    header.resize(std::min(size_t(std::max<std::streamsize>(stream.gcount(), 0)),
                           std::min(header.find("end_header"), header.size())));
    std::vector<std::string> names;
    for (size_t begin = 0; begin < header.size();) {
        const size_t end = std::min(header.find('\n', begin), header.size());
        std::string line = header.substr(begin, end - begin);
        while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
        if (line.starts_with("property ")) names.push_back(line.substr(line.rfind(' ') + 1));
        begin = end + 1;
    }
    return names;
}

void readPlyMesh(const Parameters& p, ShapeRecord& shape, Dictionary& dictionary) {
    const Parameter& filename = p.needed("filename", {"string"});
    const std::string name = p.text("filename", "");
    const SceneFile file = findSceneFile(dictionary.folder, name);
    if (!file.refusal.empty()) refuse(filename.place, file.refusal, file.hint);
    std::error_code error;
    if (!std::filesystem::exists(file.path, error))
        refuse(filename.place, fmt::format("there is no file {}", inQuotes(name)));
    const std::vector<std::string> properties = plyProperties(file.path);
    const auto has = [&](std::string_view property) {
        return std::find(properties.begin(), properties.end(), property) != properties.end();
    };
    if (const Parameter* displacement = p.find("displacement", {"texture", "string", "float"}))
        dictionary.unsupported(fmt::format("\"displacement\" of {}", p.owner()), displacement->place, {},
                               "the surface stays as it is");
    p.ignore({"edgelength", "displacement.edgelength", "displacement.uvscale"});
    shape.plugin = {{"type", "ply"}, {"filename", name}};
    if (!has("nx")) shape.plugin["face_normals"] = true;  // without normals pbrt shades flat
    shape.lacksTexcoords = !has("u") && !has("s");
}

Json transformed(const std::vector<double>& points, const Matrix4& m, bool asDirections, double factor) {
    Json result = Json::array();
    auto& array = result.get_ref<Json::array_t&>();
    array.reserve(points.size());
    for (size_t i = 0; i < points.size(); i += 3) {
        const Vec3d v(points[i], points[i + 1], points[i + 2]);
        Vec3d out;
        if (asDirections)
            m.multDirMatrix(v * factor, out);
        else
            m.multVecMatrix(v, out);
        for (int c = 0; c < 3; ++c) array.emplace_back(out[c]);
    }
    return result;
}

/// Every triangle with vertices of its own, and pbrt's texture coordinates for meshes that have none.
ShapeRecord withOwnCorners(const ShapeRecord& shape) {
    ShapeRecord result = shape;
    result.positions.clear(), result.normals.clear(), result.indices.clear();
    for (size_t i = 0; i < shape.indices.size(); ++i) {
        const auto from = [&](const std::vector<double>& all, std::vector<double>& corners) {
            if (all.empty()) return;
            const size_t vertex = 3 * size_t(shape.indices[i]);
            corners.insert(corners.end(), {all[vertex], all[vertex + 1], all[vertex + 2]});
        };
        from(shape.positions, result.positions);
        from(shape.normals, result.normals);
        result.texcoords.insert(result.texcoords.end(), {i % 3 == 0 ? 0.0 : 1.0, i % 3 == 2 ? 1.0 : 0.0});
        result.indices.push_back(double(i));
    }
    return result;
}

Json meshEntry(const ShapeRecord& shape, const Matrix4& m) {
    Json entry = shape.plugin;
    entry["positions"] = transformed(shape.positions, m, false, 1);
    // ReverseOrientation turns normals around, a mirroring does not: normals are moved with the surface, and so must
    // the winding of a mesh without normals.
    const bool turned = shape.normals.empty() && shape.reversed != (linearDeterminant(m) < 0);
    Json triangles = Json::array();
    auto& array = triangles.get_ref<Json::array_t&>();
    array.reserve(shape.indices.size());
    for (size_t i = 0; i < shape.indices.size(); i += 3)
        for (const size_t corner : {size_t(0), turned ? size_t(2) : size_t(1), turned ? size_t(1) : size_t(2)})
            array.emplace_back(uint32_t(shape.indices[i + corner]));
    entry["triangles"] = std::move(triangles);
    if (!shape.normals.empty())
        entry["normals"] = transformed(shape.normals, m.inverse().transposed(), true, shape.reversed ? -1 : 1);
    if (!shape.texcoords.empty()) entry["texcoords"] = shape.texcoords;
    return entry;
}

}  // namespace

std::optional<ShapeRecord> readShape(const std::string& type, const Parameters& parameters, const Matrix4& toWorld,
                                     bool reversed, const Textures& textures, Dictionary& dictionary) {
    struct Reader {
        const char* type;
        void (*read)(const Parameters&, ShapeRecord&, Dictionary&);
    };
    static constexpr std::array<Reader, 6> kReaders{{{"cylinder", readCylinder},
                                                     {"disk", readDisk},
                                                     {"loopsubdiv", readSubdivision},
                                                     {"plymesh", readPlyMesh},
                                                     {"sphere", readSphere},
                                                     {"trianglemesh", readTriangles}}};
    ShapeRecord shape;
    shape.toWorld = toWorld;
    shape.reversed = reversed;
    shape.place = parameters.place();
    std::vector<std::string> names;
    for (const Reader& reader : kReaders) {
        names.emplace_back(reader.type);
        if (type != reader.type) continue;
        reader.read(parameters, shape, dictionary);
        if (parameters.find("alpha", {"float", "texture"})) shape.alpha = textures.number(parameters, "alpha", 1);
        parameters.finish();
        return shape;
    }
    dictionary.unknown("shape", type, names, parameters.place(), "it is left out");
    return {};
}

std::optional<double> lightArea(const ShapeRecord& shape) {
    const std::string type = shape.plugin["type"];
    const double scale = std::abs(uniformScale(shape.toWorld).value_or(1));
    if (type == "sphere") return 4 * kPi * std::pow(shape.plugin["radius"].get<double>() * scale, 2);
    if (type == "cylinder")
        return 2 * kPi * shape.plugin["radius"].get<double>() *
               (shape.plugin["p1"][2].get<double>() - shape.plugin["p0"][2].get<double>()) * scale * scale;
    const auto direction = [&](const Vec3d& v) {
        Vec3d out;
        shape.toWorld.multDirMatrix(v, out);
        return out;
    };
    if (type == "disk") return kPi * direction({1, 0, 0}).cross(direction({0, 1, 0})).length();
    std::optional<double> common;
    for (size_t i = 0; i < shape.indices.size(); i += 3) {
        const auto vertex = [&](size_t corner) {
            const size_t at = 3 * size_t(shape.indices[i + corner]);
            return Vec3d(shape.positions[at], shape.positions[at + 1], shape.positions[at + 2]);
        };
        const double area = direction(vertex(1) - vertex(0)).cross(direction(vertex(2) - vertex(0))).length() / 2;
        if (common && std::abs(area - *common) > 1e-4 * *common) return {};
        common = area;
    }
    return common;
}

Json shapeEntry(const ShapeRecord& shape, const Matrix4& moved, Materials& materials) {
    const Matrix4 m = shape.toWorld * moved;
    const bool mirrored = linearDeterminant(m) < 0;
    const bool lacksTexcoords = shape.isMesh() ? shape.texcoords.empty() : shape.lacksTexcoords;
    const bool needsTexcoords =
        lacksTexcoords && (materials.isTextured(shape.material) || (shape.alpha && !shape.alpha->isConstant()));
    if (needsTexcoords && !shape.isMesh())
        refuse(shape.place, "a textured mesh in a file without texture coordinates is not supported",
               "give the file properties u and v");
    Json entry;
    if (shape.isMesh()) {
        entry = meshEntry(needsTexcoords ? withOwnCorners(shape) : shape, m);
    } else {
        entry = shape.plugin;
        if (m != Matrix4()) entry["to_world"] = matrixJson(m);
        // Here a mirroring turns a sphere's normals around, and those of a mesh without normals.
        const bool turnsWithMirror = entry["type"] == "sphere" || entry.contains("face_normals");
        if (shape.reversed != (mirrored && turnsWithMirror)) entry["flip_normals"] = true;
    }
    entry["bsdf"] = materials.use(shape.material, shape.parametrization, shape.alpha);
    if (!shape.emitter.is_null()) entry["emitter"] = shape.emitter;
    return entry;
}

}  // namespace ulam::pbrt
