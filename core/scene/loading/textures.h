#pragma once
// Texture plugins: they may stand in the place of a colour or a number.

#include "core/scene/loading/context.h"
#include "core/scene/plugins.h"
#include "core/scene/texture.h"

namespace ulam {

std::vector<PluginInfo> texturePlugins();

Texture readTexture(const JsonNode& node, LoadContext& context);
/// The picture of a bitmap, scaled and inverted as it says.
Image readPicture(const JsonNode& node, LoadContext& context);

/// Fails where a texture holds values beyond the bounds of the parameter whose place it takes. Positive ones that are too
/// small are raised by the BSDF: black parts of roughness maps are common.
void checkTexture(const Texture& texture, const JsonNode& node, const ParameterInfo& parameter);

}  // namespace ulam
