#pragma once
// BSDFs made of others: twosided, mask, blendbsdf, mixturebsdf, bumpmap, normalmap,
// coating, roughcoating.

#include "core/scene/loading/materials.h"

namespace ulam {

PluginInfo twosidedInfo();
PluginInfo maskInfo();
PluginInfo blendInfo();
PluginInfo mixtureInfo();
PluginInfo bumpmapInfo();
PluginInfo normalmapInfo();
PluginInfo coatingInfo();
PluginInfo roughCoatingInfo();

/// `depth`: see readMaterial.
Material readTwosided(const JsonNode& node, PluginResolver& resolver, int depth);
Material readMask(const JsonNode& node, PluginResolver& resolver, int depth);
Material readBlend(const JsonNode& node, PluginResolver& resolver, int depth);
Material readMixture(const JsonNode& node, PluginResolver& resolver, int depth);
Material readBumpmap(const JsonNode& node, PluginResolver& resolver, int depth);
Material readNormalmap(const JsonNode& node, PluginResolver& resolver, int depth);
Material readCoating(const JsonNode& node, PluginResolver& resolver, int depth);
Material readRoughCoating(const JsonNode& node, PluginResolver& resolver, int depth);

}  // namespace ulam
