#include "core/scene/export/mitsuba.h"

#include <algorithm>
#include <array>
#include <map>
#include <pugixml.hpp>
#include <sstream>

#include "core/scene/export/assets.h"
#include "core/scene/export/mitsuba_dialect.h"
#include "core/scene/loading/entries.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/sensors.h"
#include "core/scene/loading/shapes.h"
#include "core/scene/loading/transform.h"

namespace ulam {
namespace {

/// A plugin with the XML tag of its kind.
struct TaggedPlugin {
    const char* tag;
    std::vector<ParameterInfo> parameters;
};

std::map<std::string, TaggedPlugin> taggedPlugins(const MitsubaDialect& dialect) {
    std::map<std::string, TaggedPlugin> result;
    for (const auto& [kind, tag] : {std::pair{PluginKind::Shapes, "shape"},
                                    {PluginKind::Bsdfs, "bsdf"},
                                    {PluginKind::Emitters, "emitter"},
                                    {PluginKind::Textures, "texture"},
                                    {PluginKind::Sensors, "sensor"},
                                    {PluginKind::Films, "film"},
                                    {PluginKind::Filters, "rfilter"}})
        for (PluginInfo& plugin : scenePlugins(kind)) {
            plugin.parameters.insert(plugin.parameters.end(), dialect.parameters.begin(), dialect.parameters.end());
            result[plugin.name] = {tag, std::move(plugin.parameters)};
        }
    return result;
}

/// Parameters for which 0 stands here for what Mitsuba takes where they are not given.
constexpr std::array kZeroIsDefault{"fov", "beam_width"};

/// Shortest decimals that read back as the same numbers.
std::string decimals(const std::vector<double>& numbers) {
    return fmt::format("{}", fmt::join(numbers, ", "));
}

std::string matrix(const Matrix4& m) {
    std::vector<double> rows;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) rows.push_back(m[column][row]);
    return fmt::format("{}", fmt::join(rows, " "));
}

pugi::xml_node appendProperty(pugi::xml_node parent, const char* tag, const std::string& name,
                              const std::string& value) {
    pugi::xml_node property = parent.append_child(tag);
    property.append_attribute("name") = name.c_str();
    property.append_attribute("value") = value.c_str();
    return property;
}

class MitsubaExporter {
public:
    MitsubaExporter(const SceneDescription& description, const std::filesystem::path& folder, const MitsubaDialect& dialect)
        : dialect_(dialect),
          plugins_(taggedPlugins(dialect)),
          scene_(description.build()),
          filmSize_(description.filmSize()),
          folder_(folder, dialect.format),
          assets_(folder_, description.folder()) {
        dictionary_ = groupsApart(withClearSensors(JsonNode(description.dictionary())));
    }

    std::vector<std::string> run();

private:
    void leaveOut(const JsonNode& node, std::string_view what) {
        leftOut_.push_back(fmt::format("{} at {}", what, node.where()));
    }
    void entry(const JsonNode& node);
    pugi::xml_node plugin(pugi::xml_node parent, const JsonNode& node);
    void property(pugi::xml_node parent, const ParameterInfo& parameter, const JsonNode& value);
    void scaled(pugi::xml_node parent, const JsonNode& node);
    pugi::xml_node mesh(pugi::xml_node parent, const JsonNode& node);
    JsonNode groupsApart(const JsonNode& dictionary) const;
    JsonNode withClearSensors(const JsonNode& dictionary) const;

    const MitsubaDialect& dialect_;
    const std::map<std::string, TaggedPlugin> plugins_;
    JsonNode dictionary_{};
    Scene scene_;
    FilmSize filmSize_;
    ExportFolder folder_;
    ExportAssets assets_;
    std::map<std::string, std::string> ids_;  // by name of an entry
    UniqueNames idNames_;
    pugi::xml_document document_;
    pugi::xml_node root_;
    std::vector<std::string> leftOut_;
};

void MitsubaExporter::property(pugi::xml_node parent, const ParameterInfo& parameter, const JsonNode& value) {
    if (value.isNull()) return;
    if (value.json() == 0 && std::ranges::find(kZeroIsDefault, parameter.name) != kZeroIsDefault.end()) return;
    const std::string name = dialect_.spelled(parameter.name);
    if (parameter.name.starts_with("to_")) {
        pugi::xml_node transform = parent.append_child("transform");
        transform.append_attribute("name") = name.c_str();
        transform.append_child("matrix").append_attribute("value") = matrix(parseTransform(value)).c_str();
    } else if (isPlugin(value) && pluginName(value) != "rgb") {
        plugin(parent, value).append_attribute("name") = name.c_str();
    } else if (parameter.type == "spectrum" || value.isObject()) {
        const Spectrum c = parseSpectrum(value);
        appendProperty(parent, "rgb", name, decimals({c.x, c.y, c.z}));
    } else if (name == "weights") {
        appendProperty(parent, "string", name, decimals(value.numbers()));
    } else if (value.isArray()) {
        const char* tag = parameter.type != "json" ? "rgb" : parameter.name.ends_with("direction") ? "vector" : "point";
        appendProperty(parent, tag, name, decimals(value.numbers(3)));
    } else if (name == "filename") {
        appendProperty(parent, "string", name,
                       assets_.copy(value, std::string_view(parent.name()) == "shape" ? "meshes" : "textures"));
    } else if (value.isString()) {
        appendProperty(parent, "string", name, value.string());
    } else if (value.isBoolean()) {
        appendProperty(parent, "boolean", name, value.boolean() ? "true" : "false");
    } else if (parameter.type == "integer") {
        appendProperty(parent, "integer", name, fmt::format("{}", value.integer()));
    } else {
        appendProperty(parent, "float", name, decimals({value.number()}));
    }
}

pugi::xml_node MitsubaExporter::plugin(pugi::xml_node parent, const JsonNode& node) {
    if (pluginName(node) == "ref") {
        pugi::xml_node reference = parent.append_child("ref");
        reference.append_attribute("id") = ids_.at(node.at("id").string()).c_str();
        return reference;
    }
    if (const auto nearest = dialect_.nearest(node)) {
        const JsonNode written(nearest->dictionary);
        if (!nearest->same) leaveOut(node, fmt::format("{}, written as {},", inQuotes(pluginName(node)), inQuotes(pluginName(written))));
        return plugin(parent, written);
    }
    if (pluginName(node) == "mesh") return mesh(parent, node);
    if (const auto baked = assets_.bakedPicture(node)) {
        pugi::xml_node picture = plugin(parent, JsonNode(baked->plugin));
        appendProperty(picture, "string", "filename", baked->file);
        return picture;
    }
    const TaggedPlugin& known = plugins_.at(pluginName(node));
    pugi::xml_node xml = parent.append_child(known.tag);
    xml.append_attribute("type") = pluginName(node).c_str();
    std::vector<std::string> lost;
    const JsonNode written(dialect_.reworded(node, lost));
    for (const std::string& what : lost) leaveOut(node, what);
    for (const auto& [key, rewritten] : written.members()) {
        if (key == "type" || key == "id") continue;
        // What stayed as it was knows its place.
        const auto original = node.find(key);
        const JsonNode member = original && original->json() == rewritten.json() ? *original : rewritten;
        const auto parameter = std::find_if(known.parameters.begin(), known.parameters.end(),
                                            [&, &name = key](const ParameterInfo& p) { return p.name == name; });
        if (parameter != known.parameters.end())
            property(xml, *parameter, member);
        else if (isPlugin(member) && pluginName(member) == "scale")
            scaled(xml, member);
        else if (isPlugin(member) && (pluginName(member) == "ref" || plugins_.contains(pluginName(member))))
            plugin(xml, member);  // without a name: its kind says what it is for, its place which one it is
        else
            leaveOut(member, fmt::format("{} of {}", inQuotes(key), inQuotes(pluginName(node))));
    }
    return xml;
}

/// A factor around a texture, which only old versions have.
void MitsubaExporter::scaled(pugi::xml_node parent, const JsonNode& node) {
    pugi::xml_node xml = parent.append_child("texture");
    xml.append_attribute("type") = "scale";
    appendProperty(xml, "float", "scale", decimals({node.at("scale").number()}));
    plugin(xml, node.at("texture"));
}

/// `mesh` is Ulam's own.
pugi::xml_node MitsubaExporter::mesh(pugi::xml_node parent, const JsonNode& node) {
    const Shape shape = readShape(node, assets_.files);
    const Mesh& loaded = std::get<Mesh>(shape.geometry);
    const std::string file = assets_.mesh(loaded, entryName(node));
    Json ply = node.json();
    for (const ParameterInfo& parameter : plugins_.at("mesh").parameters) ply.erase(parameter.name);
    ply["type"] = "ply";
    pugi::xml_node xml = plugin(parent, JsonNode(ply));
    appendProperty(xml, "string", "filename", file);
    if (loaded.normals.empty()) appendProperty(xml, "boolean", dialect_.spelled("face_normals"), "true");
    return xml;
}

/// The dictionary with the groups that stand in instances as entries of their own: Mitsuba takes references only.
JsonNode MitsubaExporter::groupsApart(const JsonNode& dictionary) const {
    Json result = dictionary.json();
    for (const JsonNode& node : entriesOf(dictionary)) {
        if (pluginName(node) != "instance") continue;
        for (const JsonNode& nested : nestedPlugins(node, plugins_.at("instance").parameters)) {
            if (pluginName(nested) != "shapegroup") continue;
            std::string name = fmt::format("{}_{}", node.key(), nested.key());
            while (result.contains(name)) name += '_';
            result[name] = nested.json();
            result[name]["id"] = name;
            result[node.key()][nested.key()] = {{"type", "ref"}, {"id", name}};
        }
    }
    return JsonNode(std::move(result));
}

/// The dictionary with the defaults written out that Mitsuba does not share.
JsonNode MitsubaExporter::withClearSensors(const JsonNode& dictionary) const {
    Json result = dictionary.json();
    for (const JsonNode& node : entriesOf(dictionary)) {
        if (!contains(scenePlugins(PluginKind::Sensors), pluginName(node))) continue;
        Json& sensor = result[node.key()];
        // Mitsuba leaves out what is too near or too far, so let there be nothing.
        const auto toWorld = node.find("to_world");
        const Matrix4 m = toWorld ? parseTransform(*toWorld) : Matrix4();
        const BoundingSphere& bounds = scene_.bounds();
        const double reach = (Vec3d(m[3][0], m[3][1], m[3][2]) - Vec3d(bounds.center)).length() + bounds.radius;
        sensor["far_clip"] = reach > 0 ? 1.01 * reach : 1.0;
        sensor["near_clip"] = 1e-9 * sensor["far_clip"].get<double>();
        // Without a size of its own a crop ends at the film's edge.
        for (const JsonNode& nested : nestedPlugins(node, plugins_.at(pluginName(node)).parameters)) {
            if (!contains(scenePlugins(PluginKind::Films), pluginName(nested))) continue;
            sensor[nested.key()]["crop_width"] = filmSize_.cropWidth;
            sensor[nested.key()]["crop_height"] = filmSize_.cropHeight;
        }
    }
    return JsonNode(std::move(result));
}

void MitsubaExporter::entry(const JsonNode& node) {
    const std::string& type = pluginName(node);
    const auto known = plugins_.find(type);
    if (noteIfUnused(node, assets_.files) || known == plugins_.end()) return leaveOut(node, inQuotes(type));
    plugin(root_, node).append_attribute("id") = ids_.at(entryName(node)).c_str();
}

std::vector<std::string> MitsubaExporter::run() {
    document_.append_child(pugi::node_comment).set_value(dialect_.format.mark);
    root_ = document_.append_child("scene");
    root_.append_attribute("version") = dialect_.version;
    if (dialect_.choosesIntegrator) {
        pugi::xml_node choice = root_.append_child("default");
        choice.append_attribute("name") = "integrator";
        choice.append_attribute("value") = "path";
        root_.append_child("integrator").append_attribute("type") = "$integrator";
    }
    const std::vector<JsonNode> entries = entriesOf(dictionary_);
    for (const JsonNode& node : entries) ids_[entryName(node)] = idNames_.make(entryName(node));
    for (const JsonNode& node : entries) entry(node);
    std::ostringstream text;
    document_.save(text, "  ");
    folder_.writeScene(text.str());
    folder_.commit();
    return leftOut_;
}

}  // namespace

std::vector<std::string> exportMitsuba3(const SceneDescription& description, const std::filesystem::path& folder) {
    return MitsubaExporter(description, folder, mitsuba3()).run();
}

std::vector<std::string> exportMitsuba06(const SceneDescription& description, const std::filesystem::path& folder) {
    return MitsubaExporter(description, folder, mitsuba06()).run();
}

}  // namespace ulam
