#include "tests/mitsuba/matrix.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/scene/plugins.h"
#include "tests/support/catch.h"

namespace ulam {
namespace {

constexpr int kColumns = 5;
constexpr double kSpacing = 1.1, kRadius = 0.48;

/// A ball of few triangles with smooth normals, and texture coordinates that go round it.
Json ball(double x, double y) {
    constexpr int kAround = 10, kDown = 6;
    Json positions = Json::array(), normals = Json::array(), texcoords = Json::array(), triangles = Json::array();
    for (int i = 0; i <= kDown; ++i)
        for (int j = 0; j <= kAround; ++j) {
            const double theta = std::numbers::pi * i / kDown, phi = 2 * std::numbers::pi * j / kAround;
            const double n[3] = {std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
            const double center[3] = {x, y, 0};
            for (int c = 0; c < 3; ++c) {
                positions.push_back(center[c] + kRadius * n[c]);
                normals.push_back(n[c]);
            }
            texcoords.push_back(2.0 * j / kAround);
            texcoords.push_back(double(i) / kDown);
        }
    for (int i = 0; i < kDown; ++i)
        for (int j = 0; j < kAround; ++j) {
            const int a = i * (kAround + 1) + j, b = a + kAround + 1;
            if (i > 0)
                for (const int k : {a, b, a + 1}) triangles.push_back(k);
            if (i + 1 < kDown)
                for (const int k : {a + 1, b, b + 1}) triangles.push_back(k);
        }
    return {{"type", "mesh"},
            {"positions", positions},
            {"normals", normals},
            {"texcoords", texcoords},
            {"triangles", triangles}};
}

Json picture() {
    return {{"type", "bitmap"}, {"filename", "pattern.pfm"}, {"raw", true}};
}

/// The dictionary of a BSDF, with what it cannot do without.
Json plainBsdf(const std::string& name) {
    const Json coat = {{"type", "roughplastic"}, {"alpha", 0.2}, {"diffuse_reflectance", {0.6, 0.3, 0.2}}};
    const Json metal = {{"type", "roughconductor"}, {"alpha", 0.3}, {"material", "Au"}};
    static const std::map<std::string, Json> kParameters{
        {"blendbsdf", {{"weight", 0.4}, {"a", coat}, {"b", metal}}},
        {"bumpmap", {{"scale", 0.3}, {"heights", picture()}, {"inside", coat}}},
        {"conductor", {{"material", "Cu"}}},
        {"mask", {{"opacity", 0.6}, {"inside", coat}}},
        {"normalmap",
         {{"normalmap", {{"type", "bitmap"}, {"filename", "normals.pfm"}, {"raw", true}}}, {"inside", coat}}},
        {"principled", {{"base_color", {0.7, 0.4, 0.2}}, {"roughness", 0.4}, {"clearcoat", 0.5}, {"metallic", 0.3}}},
        {"roughconductor", {{"alpha_u", 0.15}, {"alpha_v", 0.4}, {"material", "Al"}}},
        {"roughdielectric", {{"alpha", 0.3}}},
        {"roughplastic", {{"alpha", 0.15}}},
        {"twosided", {{"inside", metal}}},
    };
    Json bsdf = {{"type", name}};
    if (const auto given = kParameters.find(name); given != kParameters.end())
        for (const auto& [key, value] : given->second.items()) bsdf[key] = value;
    return bsdf;
}

/// With pictures for all parameters that may be one; alpha stays where it is isotropic.
Json texturedBsdf(const PluginInfo& info) {
    Json bsdf = plainBsdf(info.name);
    for (const std::string& name : info.textured)
        if (name != "eta" && name != "k" && name != "alpha" && !name.starts_with("alpha_")) bsdf[name] = picture();
    return bsdf;
}

Json lightOf(const std::string& kind) {
    if (kind == "environment") return {{"type", "envmap"}, {"filename", "sky.pfm"}};
    if (kind == "point") return {{"type", "point"}, {"position", {1, 4, 5}}, {"intensity", {60, 55, 50}}};
    return {{"type", "rectangle"},
            {"emitter", {{"type", "area"}, {"radiance", {6, 5.5, 5}}}},
            {"to_world",
             {{{"type", "scale"}, {"value", 1.5}},
              {{"type", "lookat"}, {"origin", {1, 4, 5}}, {"target", {0, 0, 0}}, {"up", {0, 1, 0}}}}}};
}

}  // namespace

std::vector<MatrixScene> matrixScenes() {
    const std::set<std::string> kOnlyHere{"coating", "mixturebsdf", "phong", "roughcoating", "roughdiffuse", "ward"};
    std::vector<PluginInfo> shown;
    for (const PluginInfo& bsdf : scenePlugins(PluginKind::Bsdfs))
        if (!kOnlyHere.contains(bsdf.name)) shown.push_back(bsdf);
    const int rows = (int(shown.size()) + kColumns - 1) / kColumns;
    std::vector<MatrixScene> scenes;
    for (const std::string kind : {"area", "point", "environment"})
        for (const bool textured : {false, true}) {
            Json scene = {
                {"type", "scene"},
                {"sensor",
                 {{"type", "perspective"},
                  {"fov", 40},
                  {"to_world",
                   {{{"type", "lookat"}, {"origin", {0, 0, 7.6}}, {"target", {0, 0, 0}}, {"up", {0, 1, 0}}}}},
                  {"film",
                   {{"type", "hdrfilm"},
                    {"width", 64},
                    {"height", 8 * ((rows * 64 / kColumns + 7) / 8)},
                    {"rfilter", {{"type", "box"}}}}}}},
                {"back",
                 {{"type", "rectangle"},
                  {"bsdf", {{"type", "diffuse"}, {"reflectance", {0.4, 0.5, 0.6}}}},
                  {"to_world", {{{"type", "scale"}, {"value", 4}}, {{"type", "translate"}, {"value", {0, 0, -1}}}}}}},
                {"light", lightOf(kind)}};
            for (size_t i = 0; i < shown.size(); ++i) {
                Json shape = ball((int(i) % kColumns - (kColumns - 1) / 2.0) * kSpacing,
                                  ((rows - 1) / 2.0 - int(i) / kColumns) * kSpacing);
                shape["bsdf"] = textured ? texturedBsdf(shown[i]) : plainBsdf(shown[i].name);
                scene[shown[i].name + " ball"] = std::move(shape);
            }
            scenes.push_back({fmt::format("matrix {} {}", kind, textured ? "textured" : "plain"), std::move(scene),
                              kind == "point" ? Json::array({"path"}) : Json::array({"path", "bdpt"})});
        }
    return scenes;
}

}  // namespace ulam
