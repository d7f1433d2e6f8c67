#include "core/scene/load.h"

#include <map>

#include "core/base/error.h"
#include "core/base/sha256.h"
#include "core/scene/loading/emitters.h"
#include "core/scene/loading/entries.h"
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

class SceneBuilder : private PluginResolver {
public:
    SceneBuilder(const JsonNode& root, const std::filesystem::path& folder) : root_(root) { context_.folder = folder; }

    Scene build(const JsonNode& film);
    FilmSettings film(const JsonNode& replacement) { return readFilm(sensorNode(), replacement, context_); }

private:
    std::vector<JsonNode> entries() const { return entriesOf(root_); }
    void nameEntries();
    JsonNode sensorNode() const;
    JsonNode resolve(const JsonNode& node) override;
    uint32_t texture(const JsonNode& node, const ParameterInfo& parameter) override;
    bool isTexture(const JsonNode& node) const override;
    JsonNode named(const JsonNode& reference, PluginKind kind, const char* what) const;
    uint32_t material(const JsonNode& node);
    uint32_t addMaterial(Material material);
    void addShape(const JsonNode& node);
    void addEmitter(const JsonNode& node);

    JsonNode root_;
    std::map<std::string, JsonNode> named_;  // entries by name
    LoadContext context_;
    Scene scene_;
    std::map<std::string, uint32_t> materials_, textures_;  // by JSON pointer of the plugin
};

JsonNode SceneBuilder::sensorNode() const {
    std::optional<JsonNode> sensor;
    for (const JsonNode& entry : entries()) {
        if (!contains(scenePlugins(PluginKind::Sensors), pluginName(entry))) continue;
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
    const auto found = named_.find(id.string());
    if (found == named_.end()) {
        std::vector<std::string> names;
        for (const JsonNode& entry : entries()) names.push_back(entryName(entry));
        unknownName("entry of the scene", id.string(), names, id.where());
    }
    const JsonNode& entry = found->second;
    if (!contains(scenePlugins(kind), pluginName(entry)))
        id.fail(fmt::format("{} is no {}, but {}", inQuotes(found->first), what, inQuotes(pluginName(entry))));
    return entry;
}

bool SceneBuilder::isTexture(const JsonNode& node) const {
    if (pluginName(node) != "ref") return contains(scenePlugins(PluginKind::Textures), pluginName(node));
    for (const JsonNode& entry : entries())
        if (entryName(entry) == node.at("id").string()) return contains(scenePlugins(PluginKind::Textures), pluginName(entry));
    return false;
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

void SceneBuilder::addShape(const JsonNode& node) {
    const auto index = uint32_t(scene_.shapes.size());
    Shape shape = readShape(node, context_);
    shape.id = node.key();
    std::optional<uint32_t> covering;
    const auto plugins = shapePlugins();
    const auto self =
        std::find_if(plugins.begin(), plugins.end(), [&](const PluginInfo& p) { return p.name == pluginName(node); });
    for (const JsonNode& nested : nestedPlugins(node, self->parameters)) {
        const std::string& name = pluginName(nested);
        if (contains(emitterPlugins(), name)) {
            if (shape.emitter != kNone) nested.fail("a shape has at most one emitter");
            shape.emitter = uint32_t(scene_.emitters.size());
            scene_.emitters.push_back(readAreaEmitter(nested, index, *this));
        } else if (name == "ref" || contains(bsdfPlugins(), name)) {
            if (covering) nested.fail("a shape has at most one BSDF");
            covering = material(nested);
        } else {
            auto possible = bsdfPlugins();
            for (PluginInfo& emitter : emitterPlugins()) possible.push_back(std::move(emitter));
            unknownPlugin(nested, "bsdf or emitter", possible);
        }
    }
    shape.material = covering ? *covering : addMaterial(defaultMaterial(shape.emitter != kNone));
    scene_.shapes.push_back(std::move(shape));
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
        if (contains(shapePlugins(), name))
            addShape(entry);
        else if (contains(bsdfPlugins(), name))
            material(entry);
        else if (contains(emitterPlugins(), name))
            addEmitter(entry);
        else if (!contains(sensorPlugins(), name) && !(contains(texturePlugins(), name) && name != "rgb"))  // textures: when used
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
    std::unique_ptr<Generator> generator;
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

const Generator* SceneDescription::generator() const {
    return content_->generator.get();
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
