#pragma once
// BSDF plugins.

#include "core/scene/loading/resolver.h"
#include "core/scene/material.h"

namespace ulam {

std::vector<PluginInfo> bsdfPlugins();

Material readMaterial(const JsonNode& node, PluginResolver& resolver);

/// An index of refraction as scenes write it: a number, or the name of a substance.
double refractiveIndex(const JsonNode& node);

/// What covers a shape without a BSDF (Mitsuba 3): grey, or black where it emits.
Material defaultMaterial(bool emits);

}  // namespace ulam
