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

/// The nested BSDFs from number i on, of which the weights' rest is left, one blended with those that follow.
Json blended(const std::vector<JsonNode>& nested, const std::vector<double>& weights, size_t i, double rest) {
    if (i == nested.size()) return {{"type", "diffuse"}, {"reflectance", 0.0}};
    const double share = rest > 0 ? std::min(1.0, weights[i] / rest) : 0;
    if (i + 1 == nested.size() && share > 1 - 1e-9) return nested[i].json();
    return {{"type", "blendbsdf"}, {"weight", 1 - share}, {"a", nested[i].json()}, {"b", blended(nested, weights, i + 1, rest - weights[i])}};
}

/// What blends of two can say too.
std::optional<Json> inBlends(const JsonNode& node) {
    if (pluginName(node) == "mixturebsdf") {
        const auto nested = nestedPlugins(node, {});
        return blended(nested, node.at("weights").numbers(nested.size()), 0, 1);
    }
    return std::nullopt;
}

/// Other renderers want a blend's weight written.
std::optional<Nearest> weighted(const JsonNode& blend) {
    if (blend.find("weight")) return std::nullopt;
    Json result = blend.json();
    result["weight"] = 0.5;
    return Nearest{std::move(result), true};
}

/// A coat over a diffuse base, or the base alone.
Json coated(const JsonNode& node, bool rough) {
    const auto nested = nestedPlugins(node, {});
    if (nested.size() != 1 || pluginName(nested[0]) != "diffuse") return nested.at(0).json();
    Json result = {{"type", rough ? "roughplastic" : "plastic"}, {"nonlinear", true}, {"diffuse_reflectance", given(nested[0], "reflectance", 0.5)}};
    // Mitsuba 3's coats are of polypropylene unless they say so.
    result["int_ior"] = given(node, "int_ior", "bk7");
    for (const char* name : {"ext_ior", "specular_reflectance", "alpha", "distribution"})
        if (const auto value = node.find(name)) result[name] = value->json();
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

std::optional<Nearest> nearestInMitsuba3(const JsonNode& node) {
    const std::string& type = pluginName(node);
    if (const auto exact = inBlends(node)) return Nearest{*exact, true};
    if (type == "blendbsdf") return weighted(node);
    if (type == "coating" || type == "roughcoating") return Nearest{coated(node, type == "roughcoating"), false};
    if (type == "roughdiffuse") return Nearest{{{"type", "diffuse"}, {"reflectance", given(node, "reflectance", 0.5)}}, false};
    if (type == "phong" || type == "ward") return Nearest{glossyPrincipled(node), false};
    return std::nullopt;
}

std::optional<Nearest> nearestInMitsuba06(const JsonNode& node) {
    if (pluginName(node) == "principled") return Nearest{plainPrincipled(node), false};
    return pluginName(node) == "blendbsdf" ? weighted(node) : std::nullopt;
}

std::optional<Nearest> nearestInPbrt4(const JsonNode& node) {
    const std::string& type = pluginName(node);
    if (const auto exact = inBlends(node)) return Nearest{*exact, true};
    if (type == "blendbsdf") return weighted(node);
    if (type == "coating" || type == "roughcoating") return Nearest{coated(node, type == "roughcoating"), false};
    if (type == "roughdiffuse") return Nearest{{{"type", "diffuse"}, {"reflectance", given(node, "reflectance", 0.5)}}, false};
    if (type == "phong" || type == "ward") {
        const auto [u, v] = glossWidth(node);
        return Nearest{glossyPlastic(given(node, "diffuse_reflectance", 0.5), glossIor(node), std::sqrt(u * v)), false};
    }
    if (type == "principled") return Nearest{plainPrincipled(node), false};
    return std::nullopt;
}

}  // namespace ulam
