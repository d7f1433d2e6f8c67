#include "core/scene/mitsuba/upgrade.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "core/scene/loading/plugin_table.h"
#include "core/scene/mitsuba/values.h"

namespace ulam {
namespace {

bool upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }

void rename(Json& plugin, const char* from, const char* to) {
    if (!plugin.contains(from) || plugin.contains(to)) return;
    plugin[to] = plugin[from];
    plugin.erase(from);
}

/// A parameter of another type than it should have is left for the loader to refuse.
double numberOf(const Json& plugin, const char* name, double otherwise) {
    const auto value = plugin.find(name);
    return value != plugin.end() && value->is_number() ? value->get<double>() : otherwise;
}

std::string textOf(const Json& plugin, const char* name) {
    const auto value = plugin.find(name);
    return value != plugin.end() && value->is_string() ? value->get<std::string>() : "";
}

/// Texture coordinates were scaled, then moved.
void upgradeTexture(Json& texture) {
    const auto take = [&](const char* name, double otherwise) {
        const double value = numberOf(texture, name, otherwise);
        texture.erase(name);
        return value;
    };
    const double uScale = take("uscale", 1), vScale = take("vscale", 1), u = take("uoffset", 0), v = take("voffset", 0);
    if (uScale == 1 && vScale == 1 && u == 0 && v == 0) return;
    texture["to_uv"] = {{{"type", "scale"}, {"value", {uScale, vScale, 1}}}, {{"type", "translate"}, {"value", {u, v, 0}}}};
}

void upgradeBitmap(Json& bitmap) {
    for (const char* name : {"cache", "max_anisotropy"}) bitmap.erase(name);
    for (const char* smooth : {"ewa", "trilinear"})
        if (textOf(bitmap, "filter_type") == smooth) bitmap["filter_type"] = "bilinear";
    // A gamma of 1 takes the numbers as they are; a negative one, the default, what the format says.
    if (bitmap.contains("gamma") && bitmap["gamma"].is_number()) {
        const double gamma = bitmap["gamma"].get<double>();
        if (gamma == 1) bitmap["raw"] = true;
        if (gamma == 1 || gamma <= 0) bitmap.erase("gamma");
    }
    if (const std::string mode = textOf(bitmap, "wrap_mode_u"); !mode.empty() && mode == textOf(bitmap, "wrap_mode_v")) {
        bitmap["wrap_mode"] = mode;
        bitmap.erase("wrap_mode_u");
        bitmap.erase("wrap_mode_v");
    }
}

void upgradeConductor(Json& bsdf) {
    if (!bsdf.contains("material") && !bsdf.contains("eta") && !bsdf.contains("k")) bsdf["material"] = "Cu";
    if (bsdf.contains("ext_eta") && (bsdf["ext_eta"] == "air" || bsdf["ext_eta"] == 1)) bsdf.erase("ext_eta");
}

/// The texture that a relief, or a texture around another, holds under any name; `other` is a type that is one too.
std::optional<std::string> textureIn(const Json& plugin, const char* other) {
    const auto textures = scenePlugins(PluginKind::Textures);
    for (const auto& [name, value] : plugin.items())
        if (const std::string type = value.is_object() ? textOf(value, "type") : ""; contains(textures, type) || type == other) return name;
    return std::nullopt;
}

/// Heights were scaled by a texture of their own.
void upgradeBumpmap(Json& bsdf) {
    const auto name = textureIn(bsdf, "scale");
    if (!name || bsdf[*name]["type"] != "scale") return;
    Json scale = bsdf[*name];
    const auto nested = textureIn(scale, "ref");
    if (!nested) return;
    if (!bsdf.contains("scale") || bsdf["scale"].is_number()) bsdf["scale"] = numberOf(bsdf, "scale", 1) * numberOf(scale, "scale", 1);
    bsdf[*name] = scale[*nested];
}

void upgradeNormalmap(Json& bsdf) {
    if (const auto name = textureIn(bsdf, "scale")) rename(bsdf, name->c_str(), "normalmap");
}

/// "0.3, 0.7"
void upgradeMixture(Json& bsdf) {
    if (!bsdf.contains("weights") || !bsdf["weights"].is_string()) return;
    if (const auto weights = parseNumbers(bsdf["weights"].get<std::string>())) bsdf["weights"] = *weights;
}

/// `sky` and `sun` are the parts of a `sunsky`, whose zenith was +y, south +z and east +x.
void upgradeSky(Json& sky, const std::string& part) {
    const Json scale = sky.contains("scale") ? sky["scale"] : Json(1);
    sky.erase("scale");
    sky.erase("resolution");
    sky["type"] = "sunsky";
    for (const char* name : {"sky", "sun"}) {
        const std::string own = std::string(name) + "_scale";
        if (part == name || (part == "sunsky" && !sky.contains(own) && scale != 1)) sky[own] = scale;
        if (part != name && part != "sunsky") sky[own] = 0;
    }
    if (!sky.contains("albedo")) sky["albedo"] = 0.2;
    // A radius of 0 was parallel light; there is nothing that the smallest disc lights differently.
    if (sky.contains("sun_radius_scale") && sky["sun_radius_scale"].is_number())
        sky["sun_aperture"] = std::max(0.01, 0.5358 * numberOf(sky, "sun_radius_scale", 1));
    sky.erase("sun_radius_scale");
    // Without effect where they are at their defaults, else refused by name.
    if (sky.contains("stretch") && sky["stretch"] == 1) sky.erase("stretch");
    if (sky.contains("extend") && sky["extend"] == false) sky.erase("extend");
    Json steps = Json::array();
    steps.push_back({{"type", "matrix"}, {"value", {0, -1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1}}});
    if (sky.contains("to_world"))
        for (Json& step : sky["to_world"]) steps.push_back(std::move(step));
    sky["to_world"] = std::move(steps);
}

}  // namespace

std::string underscored(std::string_view camelCase) {
    std::string result;
    for (size_t i = 0; i < camelCase.size(); ++i) {
        const char c = camelCase[i];
        if (upper(c) && i > 0 && lower(camelCase[i - 1])) result += '_';
        result += char(upper(c) ? std::tolower(c) : c);
    }
    return result;
}

void upgradePlugin(Json& plugin, std::string_view tag, const MitsubaVersion& version) {
    if (!version.camelCase()) return;
    const std::string type = textOf(plugin, "type");
    if (tag == "texture") upgradeTexture(plugin);
    if (type == "bitmap") upgradeBitmap(plugin);
    if (type == "diffuse") rename(plugin, "diffuse_reflectance", "reflectance");
    if (type == "bump" && version.major == 0 && version.minor < 5) plugin["type"] = "bumpmap";
    if (type == "conductor" || type == "roughconductor") upgradeConductor(plugin);
    if (plugin["type"] == "bumpmap") upgradeBumpmap(plugin);
    if (type == "normalmap") upgradeNormalmap(plugin);
    if (type == "mixturebsdf") upgradeMixture(plugin);
    if (tag == "emitter" && (type == "sky" || type == "sun" || type == "sunsky")) upgradeSky(plugin, type);
}

}  // namespace ulam
