#include "core/scene/load.h"

#include <map>

#include "core/base/error.h"
#include "core/base/sha256.h"
#include "core/scene/loading/emitters.h"
#include "core/scene/loading/entries.h"
#include "core/scene/loading/groups.h"
#include "core/scene/loading/materials.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/sensors.h"
#include "core/scene/loading/shapes.h"
#include "core/scene/loading/textures.h"
#include "core/scene/mitsuba/xml.h"
#include "core/scene/pbrt/pbrt.h"

namespace ulam {
namespace {

/// The plugins that may stand in a scene by themselves.
std::vector<PluginInfo> sceneEntries() {
    std::vector<PluginInfo> all;
    for (const PluginKind kind : {PluginKind::Shapes, PluginKind::Bsdfs, PluginKind::Emitters, PluginKind::Sensors, PluginKind::Textures})
        for (PluginInfo& plugin : scenePlugins(kind)) all.push_back(std::move(plugin));
    return all;
}

/// Beyond this an instance is refused: a small file may ask for any number of shapes.
constexpr size_t kMostShapes = size_t(1) << 22;

class SceneBuilder : private PluginResolver {
public:
    SceneBuilder(const JsonNode& root, const std::filesystem::path& folder) : root_(root) { context_.folder = folder; }

    Scene build(const JsonNode& film);
    FilmSettings film(const JsonNode& replacement) { return readFilm(sensorNode(), replacement, context_); }

private:
    std::vector<JsonNode> entries() const { return entriesOf(root_); }
    void nameEntries();
    bool isA(PluginKind kind, const JsonNode& node) const;
    JsonNode sensorNode() const;
    JsonNode resolve(const JsonNode& node) override;
    uint32_t texture(const JsonNode& node, const ParameterInfo& parameter) override;
    bool isTexture(const JsonNode& node) const override;
    JsonNode named(const JsonNode& reference, PluginKind kind, const char* what) const;
    uint32_t material(const JsonNode& node);
    uint32_t addMaterial(Material material);
    Shape shape(const JsonNode& node, bool inGroup);
    const std::vector<Shape>& group(const JsonNode& node);
    void addInstance(const JsonNode& node);
    void addEmitter(const JsonNode& node);

    JsonNode root_;
    LoadContext context_;
    Scene scene_;
    std::map<std::string, JsonNode> named_;                 // entries by name
    std::map<std::string, uint32_t> materials_, textures_;  // by JSON pointer of the plugin
    std::map<std::string, std::vector<Shape>> groups_;      // likewise
    std::map<std::string, PluginKind> kinds_ = [] {
        std::map<std::string, PluginKind> kinds;
        for (const PluginKind kind : {PluginKind::Shapes, PluginKind::Bsdfs, PluginKind::Emitters, PluginKind::Sensors, PluginKind::Textures})
            for (const PluginInfo& plugin : scenePlugins(kind)) kinds[plugin.name] = kind;
        return kinds;
    }();
};

bool SceneBuilder::isA(PluginKind kind, const JsonNode& node) const {
    const auto known = kinds_.find(pluginName(node));
    return known != kinds_.end() && known->second == kind;
}

JsonNode SceneBuilder::sensorNode() const {
    std::optional<JsonNode> sensor;
    for (const JsonNode& entry : entries()) {
        if (!isA(PluginKind::Sensors, entry)) continue;
        if (sensor) entry.fail("a scene has exactly one sensor", fmt::format("another stands at {}", sensor->where()));
        sensor = entry;
    }
    if (!sensor) root_.fail("the scene has no sensor", "add one of type \"perspective\"");
    return *sensor;
}

void SceneBuilder::nameEntries() {
    for (const JsonNode& entry : entries()) {
        const auto [first, isNew] = named_.try_emplace(entryName(entry), entry);
        if (!isNew)
            entry.fail(fmt::format("another entry is called {} too", inQuotes(first->first)),
                       fmt::format("it stands at {}", first->second.where()));
    }
}

JsonNode SceneBuilder::resolve(const JsonNode& node) { return named(node, PluginKind::Bsdfs, "BSDF"); }

/// What a reference stands for: the scene's entry of that name.
JsonNode SceneBuilder::named(const JsonNode& node, PluginKind kind, const char* what) const {
    if (pluginName(node) != "ref") return node;
    node.allowOnly("key of a reference", {"type", "id"});
    const JsonNode id = node.at("id");
    const auto entry = named_.find(id.string());
    if (entry == named_.end()) {
        std::vector<std::string> names;
        for (const auto& known : named_) names.push_back(known.first);
        unknownName("entry of the scene", id.string(), names, id.where());
    }
    if (!isA(kind, entry->second)) id.fail(fmt::format("{} is no {}, but {}", inQuotes(entry->first), what, inQuotes(pluginName(entry->second))));
    return entry->second;
}

bool SceneBuilder::isTexture(const JsonNode& node) const {
    if (pluginName(node) != "ref") return isA(PluginKind::Textures, node);
    const auto entry = named_.find(node.at("id").string());
    return entry != named_.end() && isA(PluginKind::Textures, entry->second);
}

uint32_t SceneBuilder::texture(const JsonNode& node, const ParameterInfo& parameter) {
    const JsonNode plugin = named(node, PluginKind::Textures, "texture");
    const auto known = textures_.find(plugin.pointer());
    if (known != textures_.end()) {
        checkTexture(scene_.textures[known->second], plugin, parameter);
        return known->second;
    }
    scene_.textures.push_back(readTexture(plugin, context_));
    checkTexture(scene_.textures.back(), plugin, parameter);
    return textures_[plugin.pointer()] = uint32_t(scene_.textures.size() - 1);
}

uint32_t SceneBuilder::addMaterial(Material material) {
    scene_.materials.push_back(std::move(material));
    return uint32_t(scene_.materials.size() - 1);
}

uint32_t SceneBuilder::material(const JsonNode& node) {
    const JsonNode plugin = resolve(node);
    const auto known = materials_.find(plugin.pointer());
    if (known != materials_.end()) return known->second;
    return materials_[plugin.pointer()] = addMaterial(readMaterial(plugin, *this));
}

/// The next one of the scene, or a member of a group.
Shape SceneBuilder::shape(const JsonNode& node, bool inGroup) {
    const auto index = uint32_t(scene_.shapes.size());
    Shape shape = readShape(node, context_);
    shape.id = node.key();
    std::optional<uint32_t> covering;
    for (const JsonNode& nested : nestedPlugins(node, shapeParameters(node))) {
        if (isA(PluginKind::Emitters, nested)) {
            if (inGroup) nested.fail("a shape of a shape group has no emitter", "lights stand in the scene itself");
            if (shape.emitter != kNone) nested.fail("a shape has at most one emitter");
            shape.emitter = uint32_t(scene_.emitters.size());
            scene_.emitters.push_back(readAreaEmitter(nested, index, *this));
        } else if (pluginName(nested) == "ref" || isA(PluginKind::Bsdfs, nested)) {
            if (covering) nested.fail("a shape has at most one BSDF");
            covering = material(nested);
        } else {
            auto possible = bsdfPlugins();
            for (PluginInfo& emitter : emitterPlugins()) possible.push_back(std::move(emitter));
            unknownPlugin(nested, "bsdf or emitter", possible);
        }
    }
    shape.material = covering ? *covering : addMaterial(defaultMaterial(shape.emitter != kNone));
    return shape;
}

const std::vector<Shape>& SceneBuilder::group(const JsonNode& node) {
    const auto [known, isNew] = groups_.try_emplace(node.pointer());
    if (!isNew) return known->second;
    node.allowOnly("parameter of shapegroup", structuralKeys(node, {}));
    std::vector<Shape> members;
    for (const JsonNode& nested : nestedPlugins(node, {})) {
        const std::string& name = pluginName(nested);
        if (name == "instance" || name == "shapegroup") nested.fail("a shape group holds no groups and no instances");
        if (name == "ref") nested.fail("the shapes of a shape group are written in it, not referred to");
        members.push_back(shape(nested, true));
    }
    return known->second = makeGroup(std::move(members));
}

void SceneBuilder::addInstance(const JsonNode& node) {
    std::optional<JsonNode> placed;
    for (const JsonNode& nested : nestedPlugins(node, shapeParameters(node))) {
        const JsonNode target = named(nested, PluginKind::Shapes, "shape group");
        if (pluginName(target) != "shapegroup")
            nested.fail(fmt::format("an instance places a shape group, not {}", inQuotes(pluginName(target))), "BSDFs belong to the shapes of the group");
        if (placed) nested.fail("an instance places one shape group");
        placed = target;
    }
    if (!placed) node.fail("an instance needs a shape group: a nested \"shapegroup\", or a reference to one");
    const std::vector<Shape>& members = group(*placed);
    if (scene_.shapes.size() + members.size() > kMostShapes)
        node.fail(fmt::format("instances make more than {} shapes", kMostShapes), "make one mesh of the meshes of a group");
    for (Shape& shape : readInstance(node, members)) scene_.shapes.push_back(std::move(shape));
}

void SceneBuilder::addEmitter(const JsonNode& node) {
    Emitter emitter = readEmitter(node, context_);
    if (isEnvironment(emitter) && std::any_of(scene_.emitters.begin(), scene_.emitters.end(), isEnvironment))
        node.fail("a scene has at most one environment: constant, envmap or sunsky");
    scene_.emitters.push_back(std::move(emitter));
}

Scene SceneBuilder::build(const JsonNode& film) {
    nameEntries();
    for (const JsonNode& entry : entries()) {
        const std::string& name = pluginName(entry);
        if (noteIfUnused(entry, context_)) continue;
        if (name == "shapegroup")
            group(entry);
        else if (name == "instance")
            addInstance(entry);
        else if (isA(PluginKind::Shapes, entry))
            scene_.shapes.push_back(shape(entry, false));
        else if (isA(PluginKind::Bsdfs, entry))
            material(entry);
        else if (isA(PluginKind::Emitters, entry))
            addEmitter(entry);
        else if (!isA(PluginKind::Sensors, entry) && !(isA(PluginKind::Textures, entry) && name != "rgb"))  // textures: when used
            unknownPlugin(entry, "scene plugin", sceneEntries());
    }
    const JsonNode sensor = sensorNode();
    const FilmSettings settings = readFilm(sensor, film, context_);
    scene_.sensor = readSensor(sensor, settings, context_);
    scene_.filter = settings.filter;
    if (scene_.emitters.empty()) root_.fail("the scene has no light", "add an emitter");

    std::string content = root_.json().dump();
    if (!film.isNull()) content += film.json().dump();
    for (const std::string& file : context_.fileHashes) content += file;
    scene_.hash = sha256(content);
    scene_.warnings = std::move(context_.warnings);
    if (const auto substitutions = root_.find("$substitutions"))
        for (const JsonNode& note : substitutions->elements()) scene_.substitutions.push_back(note.string());
    scene_.warnings.insert(scene_.warnings.end(), scene_.substitutions.begin(), scene_.substitutions.end());
    scene_.finalize();
    return std::move(scene_);
}

}  // namespace

struct SceneDescription::Content {
    JsonNode dictionary;
    std::filesystem::path folder;
    std::shared_ptr<const Generator> generator;
};

JsonDocument readSceneDocument(const std::filesystem::path& file, const SceneFileOptions& options) {
    if (file.extension() == ".xml") return readMitsubaXml(file, options);
    if (!options.definitions.empty()) fail(ExitCode::Usage, "-D is for Mitsuba's XML, and {} is none", inQuotes(file.string()));
    if (file.extension() == ".pbrt") return readPbrt(file, options.lenient);
    if (options.lenient)
        fail(ExitCode::Usage, "--lenient is for Mitsuba's XML and pbrt's scenes, and {} is neither", inQuotes(file.string()));
    return JsonDocument::fromFile(file);
}

SceneDescription SceneDescription::fromFile(const std::filesystem::path& file) {
    const JsonDocument document = readSceneDocument(file);
    // Not the name of another file: these could go round in a ring.
    if (document.root().isString()) document.root().expected("a scene or a generator, an object with a \"type\"");
    return fromNode(document.root(), file.parent_path());
}

SceneDescription SceneDescription::fromNode(const JsonNode& node, const std::filesystem::path& folder) {
    if (node.isString()) return fromFile(folder / node.string());
    SceneDescription description;
    if (pluginName(node) == "scene") {
        description.content_ = std::make_shared<Content>(Content{node, folder, nullptr});
        return description;
    }
    auto possible = scenePlugins(PluginKind::Generators);
    if (!contains(possible, pluginName(node))) {
        possible.insert(possible.begin(), {"scene", "", {}});
        unknownPlugin(node, "scene or generator", possible);
    }
    auto generator = Registry<Generator>::instance().create(node);
    JsonNode expanded(generator->expand());
    description.content_ = std::make_shared<Content>(Content{std::move(expanded), folder, std::move(generator)});
    return description;
}

const Json& SceneDescription::dictionary() const {
    return content_->dictionary.json();
}

const std::filesystem::path& SceneDescription::folder() const {
    return content_->folder;
}

const std::shared_ptr<const Generator>& SceneDescription::generator() const {
    return content_->generator;
}

Scene SceneDescription::build(const Json& film) const {
    Scene scene = SceneBuilder(content_->dictionary, content_->folder).build(JsonNode(film));
    if (content_->generator) scene.features = content_->generator->features();
    return scene;
}

FilmSize SceneDescription::filmSize(const Json& film) const {
    return SceneBuilder(content_->dictionary, content_->folder).film(JsonNode(film)).size;
}

}  // namespace ulam
