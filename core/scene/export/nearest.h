#pragma once
// What stands for a plugin of Ulam that another renderer does not have.

#include <optional>

#include "core/config/json.h"

namespace ulam {

struct Nearest {
    Json dictionary;
    bool same;  ///< the same scattering in other words
};

/// The nearest plugin of Mitsuba 3; none where it has the plugin itself. Textures of colours stay where the other plugin can
/// hold them, other textures become their parameter's default.
///   mixturebsdf            blends of blends: the same
///   coating, roughcoating  over diffuse (roughplastic, plastic) with `nonlinear`; over others what is nested, without the coat
///   roughdiffuse           diffuse, without the roughness
///   phong, ward            principled with the same base, lobe width and reflectance at normal incidence; its gloss is grey
///                          and rises towards grazing angles
std::optional<Nearest> nearestInMitsuba3(const JsonNode& node);

/// The same for Mitsuba 0.6, which lacks `principled` only: roughconductor, roughdielectric or roughplastic, by what there is
/// most of.
std::optional<Nearest> nearestInMitsuba06(const JsonNode& node);

/// The same for pbrt-v4, in Ulam's plugins that pbrt has.
///   roughdiffuse  diffuse, without the roughness
///   phong, ward   roughplastic with the same base, mean lobe width and reflectance at normal incidence
///   principled    roughconductor, roughdielectric or roughplastic, by what there is most of
std::optional<Nearest> nearestInPbrt4(const JsonNode& node);

}  // namespace ulam
