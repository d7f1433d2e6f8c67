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

/// Microfacets of these roughnesses over a base.
Json glossyPrincipled(const JsonNode& node, double alphaU, double alphaV) {
    const auto specular = node.find("specular_reflectance");
    const bool textured = specular && isPlugin(*specular) && pluginName(*specular) != "rgb";
    const Spectrum reflectance = specular && !textured ? parseSpectrum(*specular) : GlossParameters().specularReflectance;
    // Fresnel's reflectance at normal incidence is ((η − 1)/(η + 1))².
    const double root = std::sqrt(std::min(luminance(reflectance), 0.6));
    Json result = {{"type", "principled"},
                   {"base_color", given(node, "diffuse_reflectance", 0.5)},
                   {"eta", (1 + root) / (1 - root)},
                   {"roughness", std::pow(alphaU * alphaV, 0.25)}};
    // α_v/α_u = 1 − 0.9 anisotropic
    if (alphaU > alphaV) result["anisotropic"] = std::min(1.0, (1 - alphaV / alphaU) / 0.9);
    return result;
}

}  // namespace

std::optional<Json> nearestInMitsuba3(const JsonNode& node) {
    const std::string& type = pluginName(node);
    if (type == "roughdiffuse") return Json{{"type", "diffuse"}, {"reflectance", given(node, "reflectance", 0.5)}};
    if (type == "phong") {
        // As wide as Beckmann's distribution of this roughness (Walter et al. 2007, §5.2).
        const double alpha = std::sqrt(2 / (number(node, "exponent", Phong::Parameters().exponent) + 2));
        return glossyPrincipled(node, alpha, alpha);
    }
    if (type == "ward") {
        const double alpha = number(node, "alpha", Ward::Parameters().alpha);
        const double u = number(node, "alpha_u", 0), v = number(node, "alpha_v", 0);
        return glossyPrincipled(node, u > 0 ? u : alpha, v > 0 ? v : alpha);
    }
    return std::nullopt;
}

}  // namespace ulam
