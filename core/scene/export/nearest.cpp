#include "core/scene/export/nearest.h"

#include <algorithm>
#include <cmath>

#include "core/scene/bsdfs/phong.h"
#include "core/scene/bsdfs/ward.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"

namespace ulam {
namespace {

/// A parameter as it was given, or its default.
Json given(const JsonNode& node, const char* name, const Json& otherwise) {
    const auto value = node.find(name);
    return value ? value->json() : otherwise;
}
double number(const JsonNode& node, const char* name, double otherwise) {
    const auto value = node.find(name);
    return value && value->isNumber() ? value->number() : otherwise;
}

/// The index of refraction that reflects as much at normal incidence as the gloss: ((η − 1)/(η + 1))².
double glossIor(const JsonNode& node) {
    const auto specular = node.find("specular_reflectance");
    const bool textured = specular && isPlugin(*specular) && pluginName(*specular) != "rgb";
    const Spectrum reflectance =
        specular && !textured ? parseSpectrum(*specular) : GlossParameters().specularReflectance;
    const double root = std::sqrt(std::min(luminance(reflectance), 0.6));
    return (1 + root) / (1 - root);
}

struct GlossWidth {
    double u, v;  ///< α
};

GlossWidth glossWidth(const JsonNode& node) {
    if (pluginName(node) == "phong") {
        // As wide as Beckmann's distribution of this roughness (Walter et al. 2007, §5.2).
        const double alpha = std::sqrt(2 / (number(node, "exponent", Phong::Parameters().exponent) + 2));
        return {alpha, alpha};
    }
    const double alpha = number(node, "alpha", Ward::Parameters().alpha);
    const double u = number(node, "alpha_u", 0), v = number(node, "alpha_v", 0);
    return {u > 0 ? u : alpha, v > 0 ? v : alpha};
}

/// Microfacets of these roughnesses over a base.
Json glossyPrincipled(const JsonNode& node) {
    const auto [alphaU, alphaV] = glossWidth(node);
    Json result = {{"type", "principled"},
                   {"base_color", given(node, "diffuse_reflectance", 0.5)},
                   {"eta", glossIor(node)},
                   {"roughness", std::pow(alphaU * alphaV, 0.25)}};
    // α_v/α_u = 1 − 0.9 anisotropic
    if (alphaU > alphaV) result["anisotropic"] = std::min(1.0, (1 - alphaV / alphaU) / 0.9);
    return result;
}

Json glossyPlastic(const Json& base, double ior, double alpha) {
    return {{"type", "roughplastic"}, {"diffuse_reflectance", base},           {"int_ior", ior},   {"ext_ior", 1},
            {"distribution", "ggx"},  {"alpha", std::clamp(alpha, 1e-4, 1.0)}, {"nonlinear", true}};
}

/// Metal, glass or plastic, whichever there is most of.
Json plainPrincipled(const JsonNode& node) {
    const Json base = given(node, "base_color", 0.5);
    const double roughness = number(node, "roughness", 0.5), alpha = std::clamp(roughness * roughness, 1e-4, 1.0);
    const double specular = number(node, "specular", 0.5);
    const double ior = number(node, "eta", 2 / (1 - std::sqrt(0.08 * specular)) - 1);
    if (number(node, "metallic", 0) > 0.5)
        return {{"type", "roughconductor"},
                {"material", "none"},
                {"specular_reflectance", base},
                {"distribution", "ggx"},
                {"alpha", alpha}};
    if (number(node, "spec_trans", 0) > 0.5)
        return {
            {"type", "roughdielectric"}, {"int_ior", ior}, {"ext_ior", 1}, {"distribution", "ggx"}, {"alpha", alpha}};
    return glossyPlastic(base, ior, alpha);
}

}  // namespace

std::optional<Json> nearestInMitsuba3(const JsonNode& node) {
    const std::string& type = pluginName(node);
    if (type == "roughdiffuse") return Json{{"type", "diffuse"}, {"reflectance", given(node, "reflectance", 0.5)}};
    if (type == "phong" || type == "ward") return glossyPrincipled(node);
    return std::nullopt;
}

std::optional<Json> nearestInPbrt4(const JsonNode& node) {
    const std::string& type = pluginName(node);
    if (type == "roughdiffuse") return Json{{"type", "diffuse"}, {"reflectance", given(node, "reflectance", 0.5)}};
    if (type == "phong" || type == "ward") {
        const auto [u, v] = glossWidth(node);
        return glossyPlastic(given(node, "diffuse_reflectance", 0.5), glossIor(node), std::sqrt(u * v));
    }
    if (type == "principled") return plainPrincipled(node);
    return std::nullopt;
}

}  // namespace ulam
