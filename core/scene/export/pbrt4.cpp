#include "core/scene/export/pbrt4.h"

#include <algorithm>
#include <cmath>

#include "core/scene/export/pbrt4_materials.h"
#include "core/scene/loading/emitters.h"
#include "core/scene/loading/entries.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/sensors.h"
#include "core/scene/loading/shapes.h"
#include "core/scene/loading/transform.h"
#include "core/scene/octahedral_map.h"

namespace ulam {
namespace {

constexpr ExportFormat kFormat{"scene.pbrt", "# Written by Ulam for pbrt-v4"};
constexpr int kLongestPath = 1000;  // pbrt's default is 5

std::string numbers(const Vec3d& v) {
    return fmt::format("[ {} {} {} ]", v.x, v.y, v.z);
}
std::string colour(const char* name, const Spectrum& c) {
    return fmt::format(" \"rgb {}\" [ {} {} {} ]", name, c.x, c.y, c.z);
}

std::string distant(const Vec3f& from, const Spectrum& irradiance) {
    return fmt::format("LightSource \"distant\" \"point3 from\" {} \"point3 to\" [ 0 0 0 ]{}\n", numbers(Vec3d(from)),
                       colour("L", irradiance));
}

/// Axes and origin as a directive: the rows for row vectors.
std::string transform(const Vec3d& x, const Vec3d& y, const Vec3d& z, const Vec3d& origin) {
    std::string text = "Transform [";
    // Adding 0 makes −0 a plain 0.
    for (const auto& [row, last] : {std::pair{x, 0}, {y, 0}, {z, 0}, {origin, 1}})
        text += fmt::format(" {} {} {} {}", row.x + 0, row.y + 0, row.z + 0, last);
    return text + " ]\n";
}

std::vector<ParameterInfo> shapeParameters(const std::string& name) {
    const std::vector<PluginInfo> plugins = shapePlugins();
    return std::find_if(plugins.begin(), plugins.end(), [&](const PluginInfo& p) { return p.name == name; })->parameters;
}

class Pbrt4Exporter {
public:
    Pbrt4Exporter(const SceneDescription& description, const std::filesystem::path& folder)
        : scene_(description.build()),
          filmSize_(description.filmSize()),
          dictionary_(description.dictionary()),
          folder_(folder, kFormat),
          assets_(folder_, description.folder()),
          materials_(
              assets_, [this](const JsonNode& node, std::string_view what) { leaveOut(node, what); },
              [this](const JsonNode& node) { return resolve(node); }) {}

    std::vector<std::string> run();

private:
    void leaveOut(const JsonNode& node, std::string_view what) {
        leftOut_.push_back(node.pointer().empty() ? std::string(what) : fmt::format("{} at {}", what, node.where()));
    }
    JsonNode resolve(const JsonNode& node) const;
    std::string sensor(const JsonNode& node);
    std::string film(const JsonNode& sensor);
    void shape(const JsonNode& node, const Shape& shape);
    void group(const JsonNode& node, const std::string& name);
    void instance(const JsonNode& node);
    std::string geometry(const Shape& shape, const std::string& name, bool textured, bool& reversed);
    void light(const JsonNode& node);
    std::string environment(const JsonNode& node, const EnvmapEmitter& emitter);

    Scene scene_;
    FilmSize filmSize_;
    JsonNode dictionary_;
    ExportFolder folder_;
    ExportAssets assets_;
    Pbrt4Materials materials_;
    std::map<std::string, JsonNode> entries_;
    std::map<std::string, size_t> shapes_;  ///< index by id
    std::string world_;
    std::vector<std::string> leftOut_;
};

JsonNode Pbrt4Exporter::resolve(const JsonNode& node) const {
    return isPlugin(node) && pluginName(node) == "ref" ? entries_.at(node.at("id").string()) : node;
}

/// pbrt's camera has x to the right.
std::string Pbrt4Exporter::sensor(const JsonNode& node) {
    const Perspective& camera = *scene_.sensor;
    const Vertex lens = camera.lensPoint({0, 0});
    const Vec3d axis(camera.axis());
    // Where pixels of the whole film meet the plane at distance 1.
    const auto at = [&](double x, double y) {
        const Vec3d d(camera.direction(lens, {float(x - filmSize_.cropOffsetX), float(y - filmSize_.cropOffsetY)}));
        return d / d.dot(axis);
    };
    const double width = filmSize_.width, height = filmSize_.height;
    const Vec3d corner = at(0, 0), across = at(width, 0) - corner, down = at(0, height) - corner;
    const Vec3d right = across.normalized(), up = -down.normalized();
    const double left = corner.dot(right), top = corner.dot(up), wide = across.length(), high = down.length(),
                 half = std::min(wide, high) / 2;
    const Matrix4 toWorld(right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, axis.x, axis.y, axis.z, 0,
                          camera.position().x, camera.position().y, camera.position().z, 1);
    const Matrix4 m = toWorld.inverse();
    const auto row = [&](int i) { return Vec3d(m[i][0], m[i][1], m[i][2]); };
    std::string text = transform(row(0), row(1), row(2), row(3));
    text += fmt::format("Camera \"perspective\" \"float fov\" {}", 2 * std::atan(half) * 180 / kPi);
    constexpr double kCentred = 1e-5;
    if (std::abs(left + wide / 2) > kCentred * wide || std::abs(top - high / 2) > kCentred * high)
        text += fmt::format(" \"float screenwindow\" [ {} {} {} {} ]", left / half, (left + wide) / half,
                            (top - high) / half, top / half);
    if (!camera.positionIsDelta())
        text += fmt::format(" \"float lensradius\" {} \"float focaldistance\" {}", camera.apertureRadius(),
                            node.at("focus_distance").number());
    return text + "\n" + film(node);
}

std::string Pbrt4Exporter::film(const JsonNode& sensor) {
    const FilmSize& size = filmSize_;
    std::string text = fmt::format(
        "Film \"rgb\" \"integer xresolution\" {} \"integer yresolution\" {} \"string filename\" \"scene.exr\"",
        size.width, size.height);
    if (size.cropWidth != size.width || size.cropHeight != size.height)
        text += fmt::format(" \"integer pixelbounds\" [ {} {} {} {} ]", size.cropOffsetX,
                            size.cropOffsetX + size.cropWidth, size.cropOffsetY, size.cropOffsetY + size.cropHeight);
    text += "\nPixelFilter ";
    const double radius = scene_.filter.radius();
    if (scene_.filter.type() == ReconstructionFilter::Type::Box)
        text += "\"box\"";
    else if (scene_.filter.type() == ReconstructionFilter::Type::Tent)
        text += fmt::format("\"triangle\" \"float xradius\" {0} \"float yradius\" {0}", radius);
    else
        text += fmt::format("\"gaussian\" \"float xradius\" {0} \"float yradius\" {0} \"float sigma\" {1}", radius,
                            radius / 4);
    // What else stands in the sensor and its film has no meaning here.
    const std::vector<ParameterInfo> known = filmPlugins().at(0).parameters;
    for (const JsonNode& nested : nestedPlugins(sensor, {})) {
        if (noteIfUnused(nested, assets_.files)) {
            leaveOut(nested, inQuotes(pluginName(nested)));
            continue;
        }
        for (const auto& [key, member] : nested.members()) {
            const auto hasName = [name = key](const ParameterInfo& p) { return p.name == name; };
            if (key != "type" && key != "id" && std::none_of(known.begin(), known.end(), hasName))
                leaveOut(member, fmt::format("{} of {}", inQuotes(key), inQuotes(pluginName(nested))));
        }
    }
    return text + "\n";
}

std::string Pbrt4Exporter::geometry(const Shape& shape, const std::string& name, bool textured, bool& reversed) {
    reversed = shape.flipNormals;
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
        const auto& [x, y, z] = sphere->axes;
        std::string text;
        // Axes matter to textures only, and pbrt may turn the normals of mirrored spheres.
        if (textured && sphere->axes != kWorldAxes)
            text = transform(Vec3d(x), Vec3d(y), Vec3d(z), Vec3d(sphere->center));
        else
            text = fmt::format("Translate {} {} {}\n", sphere->center.x, sphere->center.y, sphere->center.z);
        return text + fmt::format("Shape \"sphere\" \"float radius\" {}", sphere->radius);
    }
    if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
        // A transformation that does not mirror; the normal is its third axis.
        const Vec3d x(disk->axisX), y(disk->axisY), n(disk->normal);
        reversed = x.cross(y).dot(n) < 0;
        return transform(x, y, reversed ? -n : n, Vec3d(disk->center)) + "Shape \"disk\"";
    }
    if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
        const Vec3d x(cylinder->axes[0]), z(cylinder->axes[2]), y = textured ? Vec3d(cylinder->axes[1]) : z.cross(x);
        return transform(x, y, z, Vec3d(cylinder->base)) +
               fmt::format("Shape \"cylinder\" \"float radius\" {} \"float zmin\" 0 \"float zmax\" {}",
                           cylinder->radius, cylinder->length);
    }
    Mesh mesh = std::get<Mesh>(shape.geometry);
    if (textured && mesh.texcoords.empty()) {
        // Each triangle gets vertices of its own, with the coordinates that it has here.
        Mesh split;
        for (const auto& triangle : mesh.triangles) {
            const auto first = uint32_t(split.positions.size());
            for (const uint32_t vertex : triangle) {
                split.positions.push_back(mesh.positions[vertex]);
                if (!mesh.normals.empty()) split.normals.push_back(mesh.normals[vertex]);
            }
            for (const Vec2f& uv : {Vec2f(0, 0), Vec2f(1, 0), Vec2f(0, 1)}) split.texcoords.push_back(uv);
            split.triangles.push_back({first, first + 1, first + 2});
        }
        mesh = std::move(split);
    }
    return fmt::format("Shape \"plymesh\" \"string filename\" \"{}\"", assets_.mesh(mesh, name));
}

void Pbrt4Exporter::shape(const JsonNode& node, const Shape& shape) {
    const bool emits = shape.emitter != kNone;
    const auto parametrization = std::holds_alternative<Sphere>(shape.geometry) ? pbrt::Parametrization::Sphere
                                 : std::holds_alternative<Disk>(shape.geometry) ? pbrt::Parametrization::Disk
                                                                                : pbrt::Parametrization::Same;
    std::optional<JsonNode> bsdf;
    for (const JsonNode& nested : nestedPlugins(node, shapeParameters(pluginName(node))))
        if (!contains(emitterPlugins(), pluginName(nested))) bsdf = nested;
    const Pbrt4Materials::Use use =
        bsdf ? materials_.use(*bsdf, pluginName(*bsdf) == "ref" ? bsdf->at("id").string() : node.key(), parametrization)
             : materials_.plain(emits ? 0 : 0.5);
    world_ += fmt::format("AttributeBegin\nNamedMaterial \"{}\"\n", use.material);
    if (emits) {
        const auto& area = std::get<AreaEmitter>(scene_.emitters[shape.emitter]);
        if (area.texture != kNone) leaveOut(node, "the texture of \"radiance\", written as its mean,");
        world_ += fmt::format("AreaLightSource \"diffuse\"{}\n", colour("L", area.emitted));
    }
    bool reversed = false;
    const std::string text = geometry(shape, node.key(), bsdf && materials_.isTextured(*bsdf), reversed);
    world_ += fmt::format("{}{}{}\nAttributeEnd\n", reversed ? "ReverseOrientation\n" : "", text, use.alpha);
}

void Pbrt4Exporter::group(const JsonNode& node, const std::string& name) {
    world_ += fmt::format("ObjectBegin \"{}\"\n", name);
    for (const JsonNode& nested : nestedPlugins(node, {})) shape(nested, readShape(nested, assets_.files));
    world_ += "ObjectEnd\n";
}

void Pbrt4Exporter::instance(const JsonNode& node) {
    for (const JsonNode& nested : nestedPlugins(node, shapeParameters("instance"))) {
        const bool named = pluginName(nested) == "ref";
        const std::string name = named ? nested.at("id").string() : node.key();
        if (!named) group(nested, name);
        const auto toWorld = node.find("to_world");
        const Matrix4 m = toWorld ? parseTransform(*toWorld) : Matrix4();
        const auto row = [&](int i) { return Vec3d(m[i][0], m[i][1], m[i][2]); };
        world_ += fmt::format("AttributeBegin\n{}ObjectInstance \"{}\"\nAttributeEnd\n", transform(row(0), row(1), row(2), row(3)), name);
    }
}

std::string Pbrt4Exporter::environment(const JsonNode& node, const EnvmapEmitter& emitter) {
    // As many texels as the picture has around its equator.
    int size = 512;
    if (const auto filename = node.find("filename")) {
        const Image picture = assets_.files.readImage(*filename, false);
        size = std::clamp(picture.width == picture.height ? picture.width : picture.width * 5 / 8, 16, 8192);
    }
    std::string text = fmt::format("LightSource \"infinite\" \"string filename\" \"{}\"\n",
                                   assets_.image(octahedralFromMap(*emitter.map, size), "environment"));
    if (const auto& sun = emitter.map->sun()) {
        leaveOut(node, "the disc of the sun, written as parallel light,");
        text += distant(sun->direction(), sun->radiance() * sun->solidAngle());
    }
    return text;
}

void Pbrt4Exporter::light(const JsonNode& node) {
    const Emitter emitter = readEmitter(node, assets_.files);
    if (const auto* point = std::get_if<PointEmitter>(&emitter)) {
        world_ += fmt::format("LightSource \"point\" \"point3 from\" {}{}\n", numbers(Vec3d(point->position)),
                              colour("I", point->intensity));
    } else if (const auto* spot = std::get_if<SpotEmitter>(&emitter)) {
        const double cone = spot->cutoff * 180 / kPi, beam = spot->beam * 180 / kPi;
        if (cone > beam) leaveOut(node, "the linear edge of \"spot\", written as a smooth one,");
        world_ += fmt::format(
            "LightSource \"spot\" \"point3 from\" {} \"point3 to\" {} \"float coneangle\" {} \"float conedeltaangle\" "
            "{}{}\n",
            numbers(Vec3d(spot->position)), numbers(Vec3d(spot->position) + Vec3d(spot->frame.n)), cone, cone - beam,
            colour("I", spot->intensity));
    } else if (const auto* sun = std::get_if<DirectionalEmitter>(&emitter)) {
        world_ += distant(sun->position, sun->irradiance);
    } else if (const auto* constant = std::get_if<ConstantEmitter>(&emitter)) {
        world_ += fmt::format("LightSource \"infinite\"{}\n", colour("L", constant->emitted));
    } else if (const auto* map = std::get_if<EnvmapEmitter>(&emitter)) {
        world_ += environment(node, *map);
    } else {
        leaveOut(node, inQuotes(pluginName(node)));
    }
}

std::vector<std::string> Pbrt4Exporter::run() {
    const std::vector<JsonNode> entries = entriesOf(dictionary_);
    for (const JsonNode& node : entries) entries_.emplace(entryName(node), node);
    for (size_t i = 0; i < scene_.shapes.size(); ++i) shapes_.emplace(scene_.shapes[i].id, i);
    // Before their instances.
    for (const JsonNode& node : entries)
        if (pluginName(node) == "shapegroup") group(node, entryName(node));
    std::string head = fmt::format("{}\nIntegrator \"volpath\" \"integer maxdepth\" {}\n", kFormat.mark, kLongestPath);
    for (const JsonNode& node : entries) {
        const std::string& type = pluginName(node);
        if (noteIfUnused(node, assets_.files))
            leaveOut(node, inQuotes(type));
        else if (contains(scenePlugins(PluginKind::Sensors), type))
            head += sensor(node);
        else if (type == "instance")
            instance(node);
        else if (const auto found = shapes_.find(node.key()); type != "shapegroup" && contains(shapePlugins(), type))
            shape(node, scene_.shapes[found->second]);
        else if (contains(emitterPlugins(), type))
            light(node);
        else if (type != "shapegroup" && !contains(scenePlugins(PluginKind::Bsdfs), type) &&
                 !contains(scenePlugins(PluginKind::Textures), type))
            leaveOut(node, inQuotes(type));
    }
    if (materials_.countTwosided() > 0)
        leftOut_.push_back(
            fmt::format("black backs of {} BSDFs, which reflect on both sides in pbrt", materials_.countTwosided()));
    folder_.writeScene(head + "WorldBegin\n" + materials_.text() + world_);
    folder_.commit();
    return leftOut_;
}

}  // namespace

std::vector<std::string> exportPbrt4(const SceneDescription& description, const std::filesystem::path& folder) {
    return Pbrt4Exporter(description, folder).run();
}

}  // namespace ulam
