#include "core/scene/export/mitsuba_dialect.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>

#include "core/scene/bsdfs/metals.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"

namespace ulam {
namespace {

std::string asItIs(const std::string& name) { return name; }
bool isRelief(const std::string& type) { return type == "bumpmap" || type == "normalmap"; }
constexpr std::array kReliefSwitches{"flip_invalid_normals", "use_shadowing_function"};

/// Mitsuba 3.9.1 turns normals of bump and normal maps that face away, and darkens what they light, unless told not to.
Json inNewWords(const JsonNode& plugin, std::vector<std::string>&) {
    Json result = plugin.json();
    if (isRelief(pluginName(plugin)))
        for (const char* name : kReliefSwitches) result[name] = false;
    return result;
}

/// "to_world" becomes "toWorld", "int_ior" "intIOR".
std::string camelCase(const std::string& name) {
    if (name == "int_ior") return "intIOR";
    if (name == "ext_ior") return "extIOR";
    std::string result;
    for (size_t i = 0; i < name.size(); ++i) {
        if (name[i] == '_' && i + 1 < name.size()) result += char(std::toupper(static_cast<unsigned char>(name[++i])));
        else result += name[i];
    }
    return result;
}

/// Texture coordinates are scaled, then moved.
void scaleAndMove(Json& texture, std::vector<std::string>& lost) {
    if (!texture.contains("to_uv")) return;
    const Matrix4 m = parseTransform(JsonNode(texture["to_uv"]));
    texture.erase("to_uv");
    if (m[0][1] != 0 || m[1][0] != 0) lost.emplace_back("the turn in \"to_uv\"");
    for (const auto& [name, value, otherwise] :
         {std::tuple{"uscale", m[0][0], 1.0}, {"vscale", m[1][1], 1.0}, {"uoffset", m[3][0], 0.0}, {"voffset", m[3][1], 0.0}})
        if (value != otherwise) texture[name] = value;
}

void oldBitmap(Json& bitmap) {
    if (bitmap.value("raw", false)) bitmap["gamma"] = 1.0;
    bitmap.erase("raw");
    if (bitmap.value("filter_type", "bilinear") == "bilinear") bitmap["filter_type"] = "trilinear";
}

/// Constants as numbers: the names stand for spectra there.
void oldMetal(Json& bsdf) {
    const Metal* metal = findMetal(bsdf.value("material", "none"));
    const bool mirror = !bsdf.contains("eta") && !bsdf.contains("k") && bsdf.value("material", "none") == "none";
    if (mirror) {
        bsdf["material"] = "none";
        return;
    }
    const auto take = [&](const char* name, const Spectrum& constant) {
        if (!bsdf.contains(name)) bsdf[name] = {constant.x, constant.y, constant.z};
    };
    take("eta", metal->eta);
    take("k", metal->k);
    bsdf.erase("material");
    bsdf["ext_eta"] = 1.0;
}

/// Heights are scaled by a texture around them.
void oldBumpmap(Json& bsdf, std::vector<std::string>& lost) {
    if (!bsdf.contains("scale")) return;
    const Json scale = bsdf["scale"];
    bsdf.erase("scale");
    const auto textures = scenePlugins(PluginKind::Textures);
    for (auto& [key, value] : bsdf.items()) {
        if (!value.is_object() || !value.contains("type") || !contains(textures, value["type"])) continue;
        value = {{"type", "scale"}, {"scale", scale}, {"texture", value}};
        return;
    }
    lost.emplace_back("the scale of heights that are a reference");
}

/// The zenith was +y, south +z and east +x; the sun is another model's.
void oldSky(Json& sky, std::vector<std::string>& lost) {
    if (sky.value("sun_scale", 1.0) > 0) lost.emplace_back("the radiance of the sun, which is another there,");
    if (!sky.contains("albedo")) sky["albedo"] = 0.3;
    if (sky.contains("sun_aperture")) sky["sun_radius_scale"] = sky["sun_aperture"].get<double>() / 0.5358;
    for (const char* name : {"sun_aperture", "complex_sun"}) sky.erase(name);
    // Rows of what points are multiplied with from the left.
    const Matrix4 turn(0, -1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1);
    const Matrix4 m = turn * parseTransform(sky.contains("to_world") ? JsonNode(sky["to_world"]) : JsonNode());
    Json rows = Json::array();
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) rows.push_back(m[column][row]);
    sky["to_world"] = rows;
}

Json inOldWords(const JsonNode& plugin, std::vector<std::string>& lost) {
    Json result = plugin.json();
    const std::string& type = pluginName(plugin);
    if (type == "bitmap" || type == "checkerboard") scaleAndMove(result, lost);
    if (type == "bitmap") oldBitmap(result);
    if (type == "conductor" || type == "roughconductor") oldMetal(result);
    if (type == "hdrfilm") result["banner"] = false;
    if (isRelief(type))
        for (const char* name : kReliefSwitches) result.erase(name);
    if (type == "bumpmap") oldBumpmap(result, lost);
    if (type == "sunsky") oldSky(result, lost);
    return result;
}

ParameterInfo parameter(const char* name, const char* type) {
    ParameterInfo info;
    info.name = name;
    info.type = type;
    return info;
}

}  // namespace

const MitsubaDialect& mitsuba3() {
    static const MitsubaDialect dialect{"3.0.0", {"scene.xml", " Written by Ulam for Mitsuba 3 "}, nearestInMitsuba3, asItIs, inNewWords, {}, false};
    return dialect;
}

const MitsubaDialect& mitsuba06() {
    static const MitsubaDialect dialect{
        "0.6.0",
        {"scene.xml", " Written by Ulam for Mitsuba 0.6 "},
        nearestInMitsuba06,
        camelCase,
        inOldWords,
        {parameter("uscale", "number"), parameter("vscale", "number"), parameter("uoffset", "number"), parameter("voffset", "number"),
         parameter("gamma", "number"), parameter("ext_eta", "number"), parameter("banner", "boolean"),
         parameter("sun_radius_scale", "number")},
        true};
    return dialect;
}

}  // namespace ulam
