#include <fmt/format.h>

#include <array>
#include <list>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/suggest.h"
#include "core/scene/loading/scene_file.h"
#include "core/scene/pbrt/camera.h"
#include "core/scene/pbrt/instances.h"
#include "core/scene/pbrt/lights.h"
#include "core/scene/pbrt/pbrt.h"
#include "core/scene/pbrt/state.h"

namespace ulam::pbrt {
namespace {

namespace fs = std::filesystem;

class Reader {
public:
    Reader(const fs::path& folder, bool lenient)
        : dictionary_(folder, lenient),
          textures_(dictionary_),
          materials_(dictionary_, textures_),
          instances_(dictionary_, materials_) {}

    JsonDocument read(const fs::path& file) {
        std::error_code error;
        open_.push_back(fs::weakly_canonical(file, error));
        readFile(file, file.string(), 0);
        states_.needsClosed();
        const Place end{&files_.front(), 0};
        if (!inWorld_) refuse(end, "the scene has no WorldBegin");
        finish();
        return dictionary_.document(file.string(), end);
    }

private:
    void readFile(const fs::path& path, const std::string& name, int depth);
    void directive(Tokens& tokens, const Token& token, int depth);
    bool readWorldDirective(const std::string& name, Tokens& tokens, const Place& place);
    bool readSetting(const std::string& name, Tokens& tokens, const Place& place);
    void include(Tokens& tokens, const Place& place, int depth);
    Parameters parameters(Tokens& tokens, const std::string& kind, const std::string& type, const Place& place);
    void attribute(Tokens& tokens, const Place& place);
    void option(Tokens& tokens, const Place& place);
    void mediumInterface(Tokens& tokens, const Place& place);
    void makeNamedMedium(Tokens& tokens, const Place& place);
    void makeNamedMaterial(Tokens& tokens, const Place& place);
    void material(Tokens& tokens, const Place& place);
    void namedMaterial(Tokens& tokens, const Place& place);
    void texture(Tokens& tokens, const Place& place);
    void shape(Tokens& tokens, const Place& place);
    void light(Tokens& tokens, const Place& place);
    void areaLight(Tokens& tokens, const Place& place);
    void objectBegin(Tokens& tokens, const Place& place);
    void objectEnd(Tokens& tokens, const Place& place);
    void objectInstance(Tokens& tokens, const Place& place);
    void finish();

    Dictionary dictionary_;
    Textures textures_;
    Materials materials_;
    GraphicsStates states_;
    std::list<SourceFile> files_;
    std::vector<fs::path> open_;  ///< that are being read, links followed
    size_t bytes_ = 0;
    bool inWorld_ = false;
    std::map<std::string, Single> settings_;  ///< by directive: Camera, Film, …
    Matrix4 cameraToWorld_;
    std::vector<ShapeRecord> shapes_;
    std::vector<std::pair<Json, Place>> lights_;
    Instances instances_;
};

void Reader::readFile(const fs::path& path, const std::string& name, int depth) {
    const std::string text = ulam::readFile(path, kMaxJsonBytes);
    bytes_ += text.size();
    const SourceFile& source = files_.emplace_back(name, text);
    if (bytes_ > kMaxPbrtBytes)
        refuse({&source, 0}, fmt::format("all files that the scene includes hold more than {} bytes", kMaxPbrtBytes));
    if (const size_t zero = text.find('\0'); zero != text.npos)
        refuse({&source, zero}, "expected text, found a zero byte");
    Tokens tokens(text, source);
    for (Token token = tokens.next(); token.kind != Token::Kind::End; token = tokens.next()) {
        if (token.kind != Token::Kind::Word) tokens.unexpected(token, "a directive");
        directive(tokens, token, depth);
    }
}

void Reader::directive(Tokens& tokens, const Token& token, int depth) {
    const std::string name(token.text);
    const Place place = tokens.place(token);
    if (name == "Include") return include(tokens, place, depth);
    if (name == "Import") {
        if (!inWorld_) refuse(place, "Import stands after WorldBegin");
        states_.push("Import", place);
        include(tokens, place, depth);
        states_.pop("Import", place);
        return;
    }
    if (states_.read(name, tokens, place) || readSetting(name, tokens, place) ||
        readWorldDirective(name, tokens, place))
        return;
    std::vector<std::string> known{
        "AreaLightSource", "Attribute",         "ColorSpace",     "Import",          "Include",
        "LightSource",     "MakeNamedMaterial", "Material",       "MediumInterface", "NamedMaterial",
        "ObjectBegin",     "ObjectEnd",         "ObjectInstance", "Option",          "Shape",
        "Texture",         "WorldBegin",        "Accelerator",    "Camera",          "Film",
        "Integrator",      "PixelFilter",       "Sampler"};
    known.insert(known.end(), GraphicsStates::directives().begin(), GraphicsStates::directives().end());
    if (name == "WorldEnd")
        refuse(place, "unknown directive \"WorldEnd\"",
               "scenes of pbrt-v3 are not read; pbrt --upgrade makes them scenes of pbrt-v4");
    unknownName("directive", name, known, place.text());
}

/// What a scene has once, before WorldBegin.
bool Reader::readSetting(const std::string& name, Tokens& tokens, const Place& place) {
    static constexpr std::array kSettings{"Accelerator", "Camera", "Film", "Integrator", "PixelFilter", "Sampler"};
    if (std::find(kSettings.begin(), kSettings.end(), name) == kSettings.end()) return false;
    if (inWorld_) refuse(place, fmt::format("{} stands before WorldBegin", name));
    const std::string type = tokens.text("a type");
    if (!settings_
             .emplace(name, Single{type, Parameters::read(tokens, fmt::format("{} {}", name, inQuotes(type)), place)})
             .second)
        refuse(place, fmt::format("a scene has one {}", name));
    if (name == "Camera") {
        cameraToWorld_ = states_.now.toWorld.inverse();
        states_.nameCamera();
    }
    return true;
}

bool Reader::readWorldDirective(const std::string& name, Tokens& tokens, const Place& place) {
    struct Directive {
        const char* name;
        void (Reader::*read)(Tokens&, const Place&);
        bool onlyInWorld;
    };
    static constexpr std::array<Directive, 14> kDirectives{{{"Attribute", &Reader::attribute, false},
                                                            {"Option", &Reader::option, false},
                                                            {"MediumInterface", &Reader::mediumInterface, false},
                                                            {"MakeNamedMedium", &Reader::makeNamedMedium, false},
                                                            {"Material", &Reader::material, true},
                                                            {"MakeNamedMaterial", &Reader::makeNamedMaterial, true},
                                                            {"NamedMaterial", &Reader::namedMaterial, true},
                                                            {"Texture", &Reader::texture, true},
                                                            {"Shape", &Reader::shape, true},
                                                            {"LightSource", &Reader::light, true},
                                                            {"AreaLightSource", &Reader::areaLight, true},
                                                            {"ObjectBegin", &Reader::objectBegin, true},
                                                            {"ObjectInstance", &Reader::objectInstance, true},
                                                            {"ObjectEnd", &Reader::objectEnd, true}}};
    if (name == "ColorSpace") {
        const std::string space = tokens.text("a colour space");
        if (space != "srgb")
            refuse(place, fmt::format("the colour space {} is not supported", inQuotes(space)), "\"srgb\" is");
        return true;
    }
    if (name == "WorldBegin") {
        if (std::exchange(inWorld_, true)) refuse(place, "a scene has one WorldBegin");
        states_.needsClosed();
        states_.now.toWorld = Matrix4();
        states_.nameCoordinates("world");
        return true;
    }
    for (const Directive& directive : kDirectives) {
        if (name != directive.name) continue;
        if (directive.onlyInWorld && !inWorld_) refuse(place, fmt::format("{} stands after WorldBegin", name));
        (this->*directive.read)(tokens, place);
        return true;
    }
    return false;
}

void Reader::include(Tokens& tokens, const Place& place, int depth) {
    const std::string name = tokens.text("a file");
    if (depth >= kMaxPbrtIncludes)
        refuse(place, fmt::format("files include each other deeper than {}", kMaxPbrtIncludes));
    const SceneFile found = findSceneFile(dictionary_.folder, name);
    if (!found.refusal.empty()) refuse(place, found.refusal, found.hint);
    std::error_code error;
    if (!fs::exists(found.path, error)) refuse(place, fmt::format("there is no file {}", inQuotes(name)));
    const fs::path real = fs::weakly_canonical(found.path, error);
    if (std::find(open_.begin(), open_.end(), real) != open_.end())
        refuse(place, fmt::format("the file {} includes itself", inQuotes(name)));
    open_.push_back(real);
    readFile(found.path, found.path.string(), depth + 1);
    open_.pop_back();
}

/// What follows a type, with the defaults of Attribute directives for its kind.
Parameters Reader::parameters(Tokens& tokens, const std::string& kind, const std::string& type, const Place& place) {
    Parameters result = Parameters::read(tokens, fmt::format("{} {}", kind, inQuotes(type)), place);
    if (const auto defaults = states_.now.defaults.find(kind); defaults != states_.now.defaults.end())
        result.addDefaults(defaults->second);
    return result;
}

void Reader::attribute(Tokens& tokens, const Place& place) {
    const std::string target = tokens.text("what the attribute is for");
    static const std::vector<std::string> kTargets{"light", "material", "medium", "shape", "texture"};
    if (std::find(kTargets.begin(), kTargets.end(), target) == kTargets.end())
        unknownName("attribute", target, kTargets, place.text());
    const Parameters given = Parameters::read(tokens, "attribute " + inQuotes(target), place);
    std::vector<Parameter>& defaults = states_.now.defaults[target];
    defaults.insert(defaults.begin(), given.all().begin(), given.all().end());
}

/// Options of pbrt's program; none of them says what is in the scene.
void Reader::option(Tokens& tokens, const Place&) {
    tokens.text("an option");
    const Token value = tokens.next();
    if (value.kind != Token::Kind::Word && value.kind != Token::Kind::Text)
        tokens.unexpected(value, "the option's value");
}

void Reader::mediumInterface(Tokens& tokens, const Place& place) {
    std::string names = tokens.text("the name of a medium");
    if (tokens.peek().kind == Token::Kind::Text) names += tokens.text("the name of a medium");
    if (!names.empty()) dictionary_.unsupported("a medium", place, {}, "it is left out");
}

void Reader::makeNamedMedium(Tokens& tokens, const Place& place) {
    tokens.text("a name");
    Parameters::read(tokens, "medium", place);
    dictionary_.unsupported("a medium", place, {}, "it is left out");
}

void Reader::material(Tokens& tokens, const Place& place) {
    const std::string type = tokens.text("a material");
    states_.now.material = {materials_.add({type, "", parameters(tokens, "material", type, place)}), "", place};
}

void Reader::makeNamedMaterial(Tokens& tokens, const Place& place) {
    const std::string name = tokens.text("a name");
    Parameters all = parameters(tokens, "material", name, place);
    all.needed("type", {"string"});
    const std::string type = all.text("type", "");
    materials_.add({type, name, std::move(all)});
}

void Reader::namedMaterial(Tokens& tokens, const Place& place) {
    states_.now.material = {0, tokens.text("a material"), place};
}

void Reader::texture(Tokens& tokens, const Place& place) {
    const std::string name = tokens.text("a name"), valueType = tokens.text("\"float\" or \"spectrum\""),
                      type = tokens.text("a type");
    textures_.define(name, valueType, type, parameters(tokens, "texture", type, place));
}

void Reader::shape(Tokens& tokens, const Place& place) {
    const std::string type = tokens.text("a shape");
    const GraphicsState& state = states_.now;
    auto shape = readShape(type, parameters(tokens, "shape", type, place), state.toWorld, state.reversed, textures_,
                           dictionary_);
    if (!shape) return;
    shape->material = state.material;
    if (state.areaLight && instances_.isOpen())
        dictionary_.unsupported("a light in an object that is instanced", place, {}, "it is left out");
    else if (state.areaLight)
        shape->emitter = readAreaLight(state.areaLight->first, state.areaLight->second, *shape, dictionary_);
    if (instances_.isOpen())
        instances_.add(std::move(*shape));
    else
        shapes_.push_back(std::move(*shape));
}

void Reader::light(Tokens& tokens, const Place& place) {
    const std::string type = tokens.text("a light");
    Json entry = readLight(type, parameters(tokens, "light", type, place), states_.now.toWorld, dictionary_);
    if (!entry.is_null()) lights_.emplace_back(std::move(entry), place);
}

void Reader::areaLight(Tokens& tokens, const Place& place) {
    const std::string type = tokens.text("a light");
    states_.now.areaLight.emplace(type, parameters(tokens, "light", type, place));
}

void Reader::objectBegin(Tokens& tokens, const Place& place) {
    instances_.begin(tokens.text("a name"), place);
    states_.push("Object", place);
}

void Reader::objectEnd(Tokens&, const Place& place) {
    states_.pop("Object", place);
    instances_.end();
}

void Reader::objectInstance(Tokens& tokens, const Place& place) {
    instances_.place(tokens.text("a name"), states_.now.toWorld, place);
}

void Reader::finish() {
    const auto setting = [&](const std::string& name, const std::string& otherwise) {
        const auto given = settings_.find(name);
        return given != settings_.end() ? given->second : Single{otherwise, Parameters()};
    };
    if (!settings_.contains("Camera")) refuse({&files_.front(), 0}, "the scene has no Camera");
    const Single camera = setting("Camera", "");
    dictionary_.add("sensor",
                    readSensor(camera, cameraToWorld_, setting("Film", "rgb"), setting("PixelFilter", "gaussian")),
                    camera.parameters.place());
    if (settings_.contains("Film")) dictionary_.note("sensor", "film", settings_.at("Film").parameters.place());
    // How pbrt makes its image has no effect here, and the loader says so.
    for (const auto& [name, key] :
         {std::pair{"Integrator", "integrator"}, {"Sampler", "sampler"}, {"Accelerator", "accelerator"}})
        if (settings_.contains(name))
            dictionary_.add(key, {{"type", settings_.at(name).type}}, settings_.at(name).parameters.place());
    for (const ShapeRecord& shape : shapes_) {
        Json entry = shapeEntry(shape, {}, materials_);
        dictionary_.add(dictionary_.name("shape"), std::move(entry), shape.place);
    }
    instances_.finish();
    materials_.addUnused();
    for (auto& [light, place] : lights_) {
        const std::string name = dictionary_.name("light");
        dictionary_.add(name, std::move(light), place);
    }
}

}  // namespace
}  // namespace ulam::pbrt

namespace ulam {

JsonDocument readPbrt(const std::filesystem::path& file, bool lenient) {
    return pbrt::Reader(file.parent_path(), lenient).read(file);
}

}  // namespace ulam
