#pragma once
// Emitter plugins.

#include "core/scene/emitter.h"
#include "core/scene/loading/context.h"
#include "core/scene/loading/resolver.h"
#include "core/scene/plugins.h"

namespace ulam {

std::vector<PluginInfo> emitterPlugins();

/// The light of the shape with this index, from the emitter nested in it.
Emitter readAreaEmitter(const JsonNode& node, uint32_t shape, PluginResolver& resolver);
/// An emitter of its own.
Emitter readEmitter(const JsonNode& node, LoadContext& context);

}  // namespace ulam
