#pragma once
// BSDF plugins.

#include <functional>

#include "core/scene/bsdf.h"
#include "core/scene/plugins.h"

namespace ulam {

std::vector<PluginInfo> bsdfPlugins();

/// Reads a BSDF plugin. `resolve` turns a nested {"type": "ref"} into the entry it names and returns others as they
/// are.
Material readMaterial(const JsonNode& node, const std::function<JsonNode(const JsonNode&)>& resolve);

/// What covers a shape without a BSDF (Mitsuba 3): grey, or black where it emits.
Material defaultMaterial(bool emits);

}  // namespace ulam
