#include "core/scene/mitsuba/xml.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/json_text.h"
#include "core/config/suggest.h"
#include "core/scene/loading/scene_file.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/mitsuba/properties.h"
#include "core/scene/mitsuba/upgrade.h"

#include <pugixml.hpp>

#include <algorithm>
#include <array>
#include <set>

namespace ulam {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxElements = 4'000'000;  // files that include files may multiply

constexpr std::array kPluginTags{"bsdf",    "emitter", "film",  "integrator", "medium",     "phase",   "rfilter",
                                 "sampler", "sensor",  "shape", "spectrum",   "subsurface", "texture", "volume"};

bool isPluginTag(std::string_view tag) { return std::find(kPluginTags.begin(), kPluginTags.end(), tag) != kPluginTags.end(); }

bool isReference(const Json& plugin) { return plugin.is_object() && plugin.value("type", Json()) == "ref" && plugin.value("id", Json()).is_string(); }

/// One file being read.
struct XmlFile {
    fs::path folder;  ///< from the scene's folder
    std::string name; ///< in messages
    std::string text;
    std::vector<size_t> lines;  ///< where they begin
    MitsubaVersion version;
    int depth = 0;  ///< of inclusion
    pugi::xml_document document;

    std::string place(size_t offset) const {
        const auto line = std::upper_bound(lines.begin(), lines.end(), offset) - lines.begin();
        return fmt::format("{}:{}:{}", name, line, offset - lines[size_t(line - 1)] + 1);
    }
};

class XmlReader {
public:
    XmlReader(const fs::path& folder, const SceneFileOptions& options) : folder_(folder), options_(options), values_(options.definitions) {}

    JsonDocument read(const fs::path& file) {
        std::error_code error;
        open_.push_back(fs::weakly_canonical(file, error));
        const auto xml = open(file, file.string(), 0);
        const pugi::xml_node root = xml->document.document_element();
        if (root.name() != std::string_view("scene")) complain(*xml, root, fmt::format("the outermost element is <{}>", root.name()), "a scene is a <scene>");
        places_.emplace_back("", placeOf(*xml, root));
        scene_ = {{"type", "scene"}};
        readChildren(*xml, root, scene_, {"", "scene", false, 0});
        followReferences();
        if (!substitutions_.empty()) scene_["$substitutions"] = substitutions_;
        for (const auto& [name, value] : options_.definitions)
            if (!asked_.contains(name)) fail(ExitCode::Usage, "{} asks for no ${}; {}", file.string(), name, listOfAsked());
        return JsonDocument::fromParts(std::move(scene_), file.string(), std::move(places_));
    }

private:
    /// Where the children of an element go.
    struct Parent {
        std::string pointer;
        std::string tag;
        bool emits;  ///< it is an emitter or inside of one: spectra mean light
        int depth;
    };

    std::unique_ptr<XmlFile> open(const fs::path& file, const std::string& name, int depth);
    static size_t offsetOf(const pugi::xml_node& node) { return size_t(std::max<ptrdiff_t>(1, node.offset_debug()) - 1); }
    static std::string placeOf(const XmlFile& file, const pugi::xml_node& node) { return file.place(offsetOf(node)); }
    [[noreturn]] static void complain(const XmlFile& file, const pugi::xml_node& node, const std::string& message, const std::string& hint = {}) {
        fail(ExitCode::InvalidConfig, "{} at {}{}{}", message, placeOf(file, node), hint.empty() ? "" : "; ", hint);
    }

    void substitute(const XmlFile& file, const pugi::xml_node& node);
    void readChildren(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent);
    void readElement(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent);
    void readPlugin(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent);
    bool replaceUnknown(const std::string& tag, Json& plugin, const std::string& where);
    void include(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent);
    std::string place(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent, const std::string& wanted);
    std::string fileFor(const XmlFile& file, const std::string& name) const;
    std::string propertyName(const XmlFile& file, const pugi::xml_node& node) const;
    void followAliases(Json& plugin, std::set<std::string>& wanted) const;
    void hoist(Json& plugin, const std::string& pointer, int depth, const std::set<std::string>& wanted);
    void followReferences();
    std::string listOfAsked() const {
        return asked_.empty() ? "it has no definitions" : "it asks for " + listInQuotes({asked_.begin(), asked_.end()});
    }

    fs::path folder_;
    const SceneFileOptions& options_;
    Definitions values_;
    std::set<std::string> asked_;
    std::vector<fs::path> searched_;  ///< folders of <path>, from the scene's folder
    Json scene_;
    std::vector<std::pair<std::string, std::string>> places_;
    std::map<std::string, std::string> aliases_;  ///< ids by alias
    std::set<std::string> inScene_;               ///< ids of the scene's own entries
    struct Hoisted {
        std::string id, name;
        Json plugin;
    };
    std::vector<Hoisted> hoisted_;                ///< nested plugins that others refer to
    std::map<std::string, int> counters_;         ///< of names without one of their own, by JSON pointer
    std::vector<fs::path> open_;                  ///< files that are being read, links followed
    size_t bytes_ = 0;                            ///< of all files
    std::vector<std::string> substitutions_;
    size_t elements_ = 0;
};

std::unique_ptr<XmlFile> XmlReader::open(const fs::path& path, const std::string& name, int depth) {
    auto file = std::make_unique<XmlFile>();
    file->name = name;
    file->depth = depth;
    file->text = readFile(path, kMaxJsonBytes);
    bytes_ += file->text.size();
    if (bytes_ > kMaxXmlBytes) fail(ExitCode::InvalidConfig, "{}: all files that the scene includes hold more than {} bytes", name, kMaxXmlBytes);
    file->lines.push_back(0);
    for (size_t i = 0; i < file->text.size(); ++i)
        if (file->text[i] == '\n') file->lines.push_back(i + 1);
    // Of a document type pugixml reads nothing: no entities are defined, none are fetched.
    const auto result = file->document.load_buffer(file->text.data(), file->text.size());
    if (!result) fail(ExitCode::InvalidConfig, "{} is no XML: {} at {}", name, result.description(), file->place(size_t(std::max<ptrdiff_t>(0, result.offset))));
    const pugi::xml_node root = file->document.document_element();
    const std::string version = root.attribute("version").value();
    const auto numbers = parseNumbers([&] {
        std::string spaced = version;
        std::replace(spaced.begin(), spaced.end(), '.', ' ');
        return spaced;
    }());
    if (!numbers || numbers->empty() || numbers->front() > 1000) complain(*file, root, fmt::format("the version of the scene is {}", inQuotes(version)), "expected one such as \"3.0.0\"");
    file->version = {int((*numbers)[0]), numbers->size() > 1 ? int(std::min(1000.0, (*numbers)[1])) : 0};
    if (file->version.major == 0 && file->version.minor < 4)
        complain(*file, root, fmt::format("scenes of Mitsuba {} are not read", version), "Mitsuba 0.6 upgrades them to its own version");
    return file;
}

/// Every $name in the element's attributes.
void XmlReader::substitute(const XmlFile& file, const pugi::xml_node& node) {
    const auto isNameCharacter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    for (pugi::xml_attribute attribute : node.attributes()) {
        const std::string text = attribute.value();
        if (!isUtf8(text)) complain(file, node, fmt::format("the attribute {} is not UTF-8", inQuotes(attribute.name())));
        if (text.find('$') == text.npos) continue;
        std::string result;
        for (size_t i = 0; i < text.size(); ++i) {
            if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] == '$') {
                result += text[++i];
            } else if (text[i] == '$') {
                size_t end = i + 1;
                while (end < text.size() && isNameCharacter(text[end])) ++end;
                const std::string whole = text.substr(i + 1, end - i - 1);
                // The longest known name: "$sizex" may be "$size" and an x.
                std::string name = whole;
                while (!name.empty() && !values_.contains(name)) name.pop_back();
                asked_.insert(name.empty() ? whole : name);
                if (name.empty()) {
                    std::vector<std::string> known;
                    for (const auto& value : values_) known.push_back(value.first);
                    unknownName("definition", whole, known, placeOf(file, node));
                }
                result += values_[name];
                i += name.size();
                // Definitions may hold others, and double each time.
                if (result.size() > kMaxXmlAttribute)
                    complain(file, node, fmt::format("the attribute {} is longer than {} bytes", inQuotes(attribute.name()), kMaxXmlAttribute));
            } else {
                result += text[i];
            }
        }
        attribute.set_value(result.c_str());
    }
}

void XmlReader::readChildren(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent) {
    if (parent.depth > kMaxXmlDepth) complain(file, node, fmt::format("elements are nested deeper than {}", kMaxXmlDepth));
    for (const pugi::xml_node& child : node.children()) {
        if (child.type() != pugi::node_element) continue;
        if (++elements_ > kMaxElements) complain(file, child, fmt::format("the scene has more than {} elements", kMaxElements));
        substitute(file, child);
        readElement(file, child, object, parent);
    }
}

/// Finds a free name in the object and notes its place. A parameter must have its own.
std::string XmlReader::place(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent, const std::string& wanted) {
    std::string name = wanted;
    if (node.attribute("name")) {
        if (object.contains(name)) complain(file, node, fmt::format("{} stands twice in one element", inQuotes(name)));
    } else {
        int& count = counters_[parent.pointer + '/' + wanted];
        while (object.contains(name)) name = fmt::format("{}_{}", wanted, ++count + 1);
    }
    places_.emplace_back(parent.pointer + '/' + escapePointerStep(name), placeOf(file, node));
    return name;
}

std::string XmlReader::propertyName(const XmlFile& file, const pugi::xml_node& node) const {
    const std::string name = node.attribute("name").value();
    if (name.empty()) complain(file, node, fmt::format("<{}> has no name", node.name()));
    if (name == "type" || name == "id") complain(file, node, fmt::format("no parameter is called {}", inQuotes(name)));
    return file.version.camelCase() ? underscored(name) : name;
}

void XmlReader::readElement(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent) {
    const std::string tag = node.name();
    const auto text = [&](const char* attribute) { return std::string(node.attribute(attribute).value()); };
    const auto needs = [&](const char* attribute) {
        if (!node.attribute(attribute)) complain(file, node, fmt::format("<{}> has no attribute {}", tag, inQuotes(attribute)));
        return text(attribute);
    };
    if (isPluginTag(tag) && (tag != "spectrum" || node.attribute("type"))) return readPlugin(file, node, object, parent);
    if (tag == "include") return include(file, node, object, parent);
    if (tag == "default") {
        values_.emplace(needs("name"), needs("value"));
    } else if (tag == "alias") {
        aliases_[needs("as")] = needs("id");
    } else if (tag == "path") {
        searched_.push_back(file.folder / needs("value"));
    } else if (tag == "ref") {
        const std::string wanted = text("name").empty() ? "ref" : propertyName(file, node);
        const std::string name = place(file, node, object, parent, wanted);
        object[name] = {{"type", "ref"}, {"id", needs("id")}};
    } else {
        const std::string name = place(file, node, object, parent, propertyName(file, node));
        // The albedo in a sky is the ground's.
        const PropertyContext context{file.version.camelCase(), parent.emits && name != "albedo", name};
        Json value;
        try {
            if (tag == "spectrum" && node.attribute("filename")) {
                const SceneFile curve = findSceneFile(folder_, fileFor(file, text("filename")));
                if (!curve.refusal.empty()) throw PropertyError{curve.refusal, curve.hint};
                std::error_code error;
                if (!fs::exists(curve.path, error)) throw PropertyError{fmt::format("there is no file {}", inQuotes(text("filename"))), {}};
                value = readSpectrumFile(readFile(curve.path, kMaxJsonBytes), context);
            } else {
                value = readProperty(node, context);
            }
        } catch (const PropertyError& error) {
            complain(file, node, error.message, error.hint);
        }
        object[name] = name == "filename" && value.is_string() ? Json(fileFor(file, value.get<std::string>())) : std::move(value);
    }
}

void XmlReader::readPlugin(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent) {
    const std::string tag = node.name(), id = node.attribute("id").value(), type = node.attribute("type").value();
    if (type.empty()) complain(file, node, fmt::format("<{}> has no type", tag));
    for (const pugi::xml_attribute& attribute : node.attributes())
        if (const std::string_view a = attribute.name(); a != "type" && a != "id" && a != "name" && a != "version")
            complain(file, node, fmt::format("<{}> has an attribute {}", tag, inQuotes(a)), "expected \"type\", \"id\", \"name\"");
    std::string wanted = tag;
    if (node.attribute("name")) wanted = propertyName(file, node);
    else if (parent.tag == "scene" && !id.empty() && id != "type" && id != "id") wanted = id;
    const std::string name = place(file, node, object, parent, wanted);
    Json plugin = {{"type", type}};
    if (!id.empty()) plugin["id"] = id;
    const Parent self{parent.pointer + '/' + escapePointerStep(name), tag, parent.emits || tag == "emitter", parent.depth + 1};
    if (!id.empty() && parent.tag == "scene") inScene_.insert(id);
    readChildren(file, node, plugin, self);
    upgradePlugin(plugin, tag, file.version);
    try {
        if (options_.lenient && replaceUnknown(tag, plugin, placeOf(file, node))) {
            if (!plugin.is_null()) object[name] = std::move(plugin);
            return;
        }
        object[name] = plainSpectrum(plugin, parent.emits).value_or(std::move(plugin));
    } catch (const PropertyError& error) {
        complain(file, node, error.message, error.hint);
    }
}

/// Puts what can be seen in the place of a plugin that is not known, or null.
bool XmlReader::replaceUnknown(const std::string& tag, Json& plugin, const std::string& where) {
    const Json magenta = {1, 0, 1};
    static const std::map<std::string, PluginKind> kKinds{
        {"bsdf", PluginKind::Bsdfs}, {"texture", PluginKind::Textures}, {"shape", PluginKind::Shapes}, {"emitter", PluginKind::Emitters}};
    const auto kind = kKinds.find(tag);
    const bool never = tag == "medium" || tag == "phase" || tag == "volume" || tag == "subsurface";
    const std::string type = plugin["type"];
    if (!never && (kind == kKinds.end() || contains(scenePlugins(kind->second), type) || plainSpectrum(plugin, false))) return false;
    const bool shown = tag == "bsdf" || tag == "texture";
    substitutions_.push_back(fmt::format("the {} {} at {} is not known: {}", tag, inQuotes(type), where, shown ? "magenta takes its place" : "it is left out"));
    if (tag == "texture") plugin = magenta;
    else if (tag == "bsdf") plugin = plugin.contains("id") ? Json{{"type", "diffuse"}, {"id", plugin["id"]}, {"reflectance", magenta}} : Json{{"type", "diffuse"}, {"reflectance", magenta}};
    else plugin = nullptr;
    return true;
}

void XmlReader::include(const XmlFile& file, const pugi::xml_node& node, Json& object, const Parent& parent) {
    if (file.depth + 1 > kMaxIncludes) complain(file, node, fmt::format("files include each other deeper than {}", kMaxIncludes));
    const std::string name = fileFor(file, node.attribute("filename").value());
    const SceneFile found = findSceneFile(folder_, name);
    if (!found.refusal.empty()) complain(file, node, found.refusal, found.hint);
    std::error_code error;
    if (!fs::exists(found.path, error)) complain(file, node, fmt::format("there is no file {}", inQuotes(name)));
    const fs::path real = fs::weakly_canonical(found.path, error);
    if (std::find(open_.begin(), open_.end(), real) != open_.end()) complain(file, node, fmt::format("the file {} includes itself", inQuotes(name)));
    open_.push_back(real);
    const auto included = open(found.path, found.path.string(), file.depth + 1);
    included->folder = fs::path(name).parent_path();
    const pugi::xml_node root = included->document.document_element();
    substitute(*included, root);
    if (root.name() == std::string_view("scene")) readChildren(*included, root, object, parent);
    else readElement(*included, root, object, parent);
    open_.pop_back();
}

/// A file's name from the scene's folder: it may start at the folder of the file that names it, or at one of <path>.
std::string XmlReader::fileFor(const XmlFile& file, const std::string& name) const {
    std::vector<fs::path> folders{file.folder};
    folders.insert(folders.end(), searched_.begin(), searched_.end());
    for (const fs::path& folder : folders) {
        const std::string candidate = (folder / name).generic_string();
        std::error_code error;
        if (const SceneFile found = findSceneFile(folder_, candidate); found.refusal.empty() && fs::exists(found.path, error)) return candidate;
    }
    return name;
}

/// Puts the ids in the place of their aliases, and notes what is referred to.
void XmlReader::followAliases(Json& plugin, std::set<std::string>& wanted) const {
    if (isReference(plugin)) {
        std::string id = plugin["id"];
        for (size_t i = 0; i <= aliases_.size() && aliases_.contains(id); ++i) id = aliases_.at(id);
        plugin["id"] = id;
        wanted.insert(id);
    } else if (plugin.is_object()) {
        for (auto& member : plugin.items()) followAliases(member.value(), wanted);
    }
}

/// Moves plugins that are referred to out of a plugin, the innermost first.
void XmlReader::hoist(Json& plugin, const std::string& pointer, int depth, const std::set<std::string>& wanted) {
    if (!plugin.is_object() || isReference(plugin)) return;
    for (auto& member : plugin.items()) hoist(member.value(), pointer + '/' + escapePointerStep(member.key()), depth + 1, wanted);
    if (depth < 2 || !plugin.contains("type") || !plugin.contains("id")) return;
    const std::string id = plugin["id"];
    std::string name = id;
    const auto hasId = [&](const Hoisted& other) { return other.id == id; };
    const auto hasName = [&](const Hoisted& other) { return other.name == name; };
    if (!wanted.contains(id) || inScene_.contains(id) || std::any_of(hoisted_.begin(), hoisted_.end(), hasId)) return;
    while (scene_.contains(name) || std::any_of(hoisted_.begin(), hoisted_.end(), hasName)) name += '_';
    const auto place = std::find_if(places_.rbegin(), places_.rend(), [&](const auto& p) { return p.first == pointer; });
    if (place != places_.rend()) places_.emplace_back('/' + escapePointerStep(name), std::string(place->second));
    hoisted_.push_back({id, name, std::exchange(plugin, {{"type", "ref"}, {"id", id}})});
}

/// References name entries of the scene here; in Mitsuba they may name what is nested in others too.
void XmlReader::followReferences() {
    std::set<std::string> wanted;
    followAliases(scene_, wanted);
    hoist(scene_, "", 0, wanted);
    for (Hoisted& entry : hoisted_) scene_[entry.name] = std::move(entry.plugin);
}

}  // namespace

JsonDocument readMitsubaXml(const fs::path& file, const SceneFileOptions& options) {
    return XmlReader(file.parent_path(), options).read(file);
}

}  // namespace ulam
