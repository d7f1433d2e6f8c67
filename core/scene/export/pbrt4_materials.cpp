#include "core/scene/export/pbrt4_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/config/suggest.h"
#include "core/scene/export/nearest.h"
#include "core/scene/loading/indices.h"
#include "core/scene/loading/materials.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"

namespace ulam {
namespace {

bool isTexture(const JsonNode& node) {
    return isPlugin(node) && pluginName(node) != "rgb";
}

std::string rgb(const Spectrum& c) {
    return fmt::format("[ {} {} {} ]", c.x, c.y, c.z);
}

/// pbrt's names of metals are "metal-Au-eta" and the like.
bool isMetalOfPbrt(const std::string& name) {
    static constexpr std::array kNames{"Ag", "Al", "Au", "Cu", "MgO", "TiO2"};
    return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

}  // namespace

bool Pbrt4Materials::isTextured(const JsonNode& bsdf) const {
    const JsonNode node = resolve_(bsdf);
    for (const auto& [key, member] : node.members())
        if (isPlugin(member)) {
            const JsonNode inside = resolve_(member);
            if (pluginName(inside) == "bitmap" || pluginName(inside) == "checkerboard" || isTextured(inside))
                return true;
        }
    return false;
}

Pbrt4Materials::Use Pbrt4Materials::plain(double reflectance) {
    return use(JsonNode(Json{{"type", "twosided"}, {"bsdf", {{"type", "diffuse"}, {"reflectance", reflectance}}}}),
               reflectance > 0 ? "default" : "black", pbrt::Parametrization::Same);
}

Pbrt4Materials::Use Pbrt4Materials::use(const JsonNode& bsdf, const std::string& name,
                                        pbrt::Parametrization parametrization) {
    const JsonNode node = resolve_(bsdf);
    parametrization_ = parametrization;
    backMatters_ = true;
    if (pluginName(node) != "mask") return {material(node, name), ""};
    const auto known = bsdfPlugins();
    const auto mask = std::find_if(known.begin(), known.end(), [](const PluginInfo& p) { return p.name == "mask"; });
    const auto nested = nestedPlugins(node, mask->parameters);
    return {material(resolve_(nested.at(0)), name), value(node, "opacity", "alpha", true, 0.5)};
}

/// The name of the material of a BSDF, which is made once for each parametrisation that its textures meet.
std::string Pbrt4Materials::material(const JsonNode& bsdf, const std::string& name) {
    const std::string key = fmt::format("{}|{}", bsdf.json().dump(), isTextured(bsdf) ? int(parametrization_) : 0);
    if (const auto made = made_.find(key); made != made_.end()) return made->second;
    const std::string line = directive(bsdf);
    const std::string unique = names_.make(name);
    text_ += fmt::format("MakeNamedMaterial \"{}\" \"string type\" {}\n", unique, line);
    return made_[key] = unique;
}

std::string Pbrt4Materials::directive(const JsonNode& bsdf) {
    const std::string& type = pluginName(bsdf);
    if (const auto nearest = nearestInPbrt4(bsdf)) {
        const JsonNode written(nearest->dictionary);
        if (!nearest->same) leaveOut_(bsdf, fmt::format("{}, written as {},", inQuotes(type), inQuotes(pluginName(written))));
        return directive(written);
    }
    if (type == "twosided") {
        const auto sides = nestedPlugins(bsdf, {});
        if (sides.size() > 1) leaveOut_(sides[1], "the back of \"twosided\"");
        backMatters_ = false;
        return directive(resolve_(sides.at(0)));
    }
    const bool isClear =
        type == "dielectric" || type == "roughdielectric" || type == "thindielectric" || type == "null";
    if (!isClear && backMatters_) ++twosided_;
    backMatters_ = false;
    if (type == "null") return "\"interface\"";
    if (type == "diffuse") return "\"diffuse\"" + value(bsdf, "reflectance", "reflectance", false, 0.5);
    if (isClear) {
        needsOne(bsdf, "specular_reflectance");
        needsOne(bsdf, "specular_transmittance");
        return fmt::format("\"{}\"{}{}", type == "thindielectric" ? type : "dielectric", index(bsdf, "bk7"),
                           type == "roughdielectric" ? roughness(bsdf) : "");
    }
    if (type == "conductor" || type == "roughconductor")
        return "\"conductor\"" + metal(bsdf) + (type == "roughconductor" ? roughness(bsdf) : "");
    if (type == "plastic" || type == "roughplastic") {
        leaveOut_(bsdf, fmt::format("{}, written as \"coateddiffuse\",", inQuotes(type)));
        needsOne(bsdf, "specular_reflectance");
        // As thin as can be: pbrt's coat absorbs.
        return "\"coateddiffuse\"" + value(bsdf, "diffuse_reflectance", "reflectance", false, 0.5) +
               index(bsdf, "polypropylene") + (type == "roughplastic" ? roughness(bsdf) : " \"float roughness\" 0") +
               " \"float thickness\" 1e-06";
    }
    std::vector<JsonNode> nested;
    for (const JsonNode& inside : nestedPlugins(bsdf, {}))
        if (const JsonNode node = resolve_(inside); contains(bsdfPlugins(), pluginName(node))) nested.push_back(node);
    if (type == "blendbsdf" && nested.size() == 2) {
        const std::string weight = value(bsdf, "weight", "amount", true, 0.5);
        const std::string first = material(nested[0], "part"), second = material(nested[1], "part");
        return fmt::format("\"mix\"{} \"string materials\" [ \"{}\" \"{}\" ]", weight, first, second);
    }
    for (const JsonNode& node : nested) {
        leaveOut_(bsdf, fmt::format("{}, written as the {} in it,", inQuotes(type), inQuotes(pluginName(node))));
        return directive(node);
    }
    leaveOut_(bsdf, fmt::format("{}, written as \"diffuse\",", inQuotes(type)));
    return "\"diffuse\"";
}

void Pbrt4Materials::needsOne(const JsonNode& bsdf, const char* parameter) {
    const auto given = bsdf.find(parameter);
    if (given && (isTexture(resolve_(*given)) || parseSpectrum(*given) != Spectrum(1.0)))
        leaveOut_(*given, fmt::format("{} of {}", inQuotes(parameter), inQuotes(pluginName(bsdf))));
}

std::string Pbrt4Materials::index(const JsonNode& bsdf, const char* otherwise) {
    const auto of = [&](const char* name, const JsonNode& fallback) {
        const auto given = bsdf.find(name);
        return refractiveIndex(given ? *given : fallback);
    };
    return fmt::format(" \"float eta\" {}", of("int_ior", JsonNode(otherwise)) / of("ext_ior", JsonNode("air")));
}

std::string Pbrt4Materials::roughness(const JsonNode& bsdf) {
    const auto distribution = bsdf.find("distribution");
    if (!distribution || distribution->string() != "ggx")
        leaveOut_(bsdf, fmt::format("Beckmann's distribution of {}, written as GGX,", inQuotes(pluginName(bsdf))));
    if (bsdf.find("alpha_u"))
        return value(bsdf, "alpha_u", "uroughness", true, 0.1) + value(bsdf, "alpha_v", "vroughness", true, 0.1) +
               " \"bool remaproughness\" false";
    return value(bsdf, "alpha", "roughness", true, 0.1) + " \"bool remaproughness\" false";
}

std::string Pbrt4Materials::metal(const JsonNode& bsdf) {
    const auto named = bsdf.find("material"), eta = bsdf.find("eta"), k = bsdf.find("k"),
               factor = bsdf.find("specular_reflectance");
    const std::string name = named ? named->string() : eta || k ? "" : "none";
    if (name == "none" && !eta && !k) return value(bsdf, "specular_reflectance", "reflectance", false, 1);
    if (factor) needsOne(bsdf, "specular_reflectance");
    if (isMetalOfPbrt(name))
        return fmt::format(" \"spectrum eta\" \"metal-{0}-eta\" \"spectrum k\" \"metal-{0}-k\"", name);
    const Metal* metal = findMetal(name.empty() ? "none" : name);
    const auto constant = [&](const char* parameter, const std::optional<JsonNode>& given, const Spectrum& otherwise) {
        if (given && isTexture(resolve_(*given)))
            leaveOut_(*given, fmt::format("the texture of {}", inQuotes(parameter)));
        else if (given)
            return fmt::format(" \"rgb {}\" {}", parameter, rgb(parseSpectrum(*given)));
        return fmt::format(" \"rgb {}\" {}", parameter, rgb(otherwise));
    };
    return constant("eta", eta, metal->eta) + constant("k", k, metal->k);
}

/// A parameter as pbrt's of another name: a constant or a texture.
std::string Pbrt4Materials::value(const JsonNode& owner, const char* parameter, const char* name, bool isNumber,
                                  const Json& otherwise) {
    const auto found = owner.find(parameter);
    const JsonNode given = found ? resolve_(*found) : JsonNode(otherwise);
    if (isTexture(given)) {
        const std::string texture = this->texture(given, isNumber);
        if (!texture.empty()) return fmt::format(" \"texture {}\" \"{}\"", name, texture);
        return isNumber ? fmt::format(" \"float {}\" 0.5", name) : fmt::format(" \"rgb {}\" [ 0.5 0.5 0.5 ]", name);
    }
    const Spectrum c = parseSpectrum(given);
    return isNumber ? fmt::format(" \"float {}\" {}", name, c.x) : fmt::format(" \"rgb {}\" {}", name, rgb(c));
}

/// The name of a texture; empty where pbrt has none of its kind.
std::string Pbrt4Materials::texture(const JsonNode& node, bool isNumber) {
    const std::string key = fmt::format("{}|{}|{}", node.pointer(), int(parametrization_), isNumber);
    if (const auto made = made_.find(key); made != made_.end()) return made->second;
    const std::string& type = pluginName(node);
    if (type != "bitmap" && type != "checkerboard") {
        leaveOut_(node, inQuotes(type));
        return made_[key] = "";
    }
    const auto text = [&](const char* name, const char* otherwise) {
        const auto given = node.find(name);
        return given ? given->string() : otherwise;
    };
    const auto toUv = node.find("to_uv");
    Matrix4 m = pbrt::toPbrt(parametrization_).inverse() * (toUv ? parseTransform(*toUv) : Matrix4());
    std::string parameters;
    if (type == "checkerboard") {
        for (int row = 0; row < 4; ++row) m[row][0] *= 2, m[row][1] *= 2;  // a square is a unit there, half of one here
        parameters = value(node, "color0", "tex1", isNumber, 0.4) + value(node, "color1", "tex2", isNumber, 0.2);
    } else {
        for (const int row : {0, 1, 3}) m[row][1] *= -1;  // its upper edge is at v = 1 there
        m[3][1] += 1;
        const auto scale = node.find("scale"), raw = node.find("raw"), invert = node.find("invert");
        const Spectrum factor = scale ? parseSpectrum(*scale) : Spectrum(1.0);
        const bool isGrey = factor.x == factor.y && factor.y == factor.z;
        const auto baked = isGrey ? std::nullopt : assets_.bakedPicture(node);
        parameters = fmt::format(" \"string filename\" \"{}\"",
                                 baked ? baked->file : assets_.copy(node.at("filename"), "textures"));
        if (!baked && factor.x != 1) parameters += fmt::format(" \"float scale\" {}", factor.x);
        if (!baked && invert && invert->boolean()) parameters += " \"bool invert\" true";
        if (!baked && raw && raw->boolean()) parameters += " \"string encoding\" \"linear\"";
        if (text("filter_type", "bilinear") == "nearest") parameters += " \"string filter\" \"point\"";
        const std::string wrap = text("wrap_mode", "repeat");
        if (wrap == "clamp") parameters += " \"string wrap\" \"clamp\"";
        if (wrap == "mirror") leaveOut_(node.at("wrap_mode"), "\"mirror\", written as \"repeat\",");
    }
    constexpr double kNothing = 1e-9;
    if (std::abs(m[0][1]) > kNothing || std::abs(m[1][0]) > kNothing) {
        leaveOut_(node, "texture coordinates that are turned against the surface's");
        m = Matrix4();
    }
    for (const auto& [name, number, otherwise] : {std::tuple{"uscale", m[0][0], 1.0},
                                                  {"vscale", m[1][1], 1.0},
                                                  {"udelta", m[3][0], 0.0},
                                                  {"vdelta", m[3][1], 0.0}})
        if (number != otherwise) parameters += fmt::format(" \"float {}\" {}", name, number);
    const std::string unique = textureNames_.make(node.key().empty() ? "texture" : node.key());
    text_ += fmt::format("Texture \"{}\" \"{}\" \"{}\"{}\n", unique, isNumber ? "float" : "spectrum",
                         type == "bitmap" ? "imagemap" : type, parameters);
    return made_[key] = unique;
}

}  // namespace ulam
