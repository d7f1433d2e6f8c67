#pragma once
// BSDF plugins.

#include "core/scene/loading/resolver.h"
#include "core/scene/material.h"

namespace ulam {

std::vector<PluginInfo> bsdfPlugins();

/// Most BSDFs around each other.
inline constexpr int kMaxLayers = 8;
/// `depth`: how many BSDFs are around this one.
Material readMaterial(const JsonNode& node, PluginResolver& resolver, int depth = 0);

/// What covers a shape without a BSDF (Mitsuba 3): grey, or black where it emits.
Material defaultMaterial(bool emits);

}  // namespace ulam
