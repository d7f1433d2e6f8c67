#pragma once
// BSDF plugins.

#include "core/scene/loading/resolver.h"
#include "core/scene/material.h"

namespace ulam {

std::vector<PluginInfo> bsdfPlugins();

Material readMaterial(const JsonNode& node, PluginResolver& resolver);

/// What covers a shape without a BSDF (Mitsuba 3): grey, or black where it emits.
Material defaultMaterial(bool emits);

}  // namespace ulam
