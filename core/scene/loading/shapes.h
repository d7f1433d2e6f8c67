#pragma once
// Shape plugins, without what is nested in them.

#include "core/scene/loading/context.h"
#include "core/scene/plugins.h"
#include "core/scene/shape.h"

namespace ulam {

std::vector<PluginInfo> shapePlugins();

/// Geometry and flipNormals of a shape, in world space.
Shape readShape(const JsonNode& node, LoadContext& context);

}  // namespace ulam
