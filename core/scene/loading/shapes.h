#pragma once
// Shape plugins, without what is nested in them.

#include "core/scene/loading/context.h"
#include "core/scene/plugins.h"
#include "core/scene/shape.h"

namespace ulam {

/// All of them, shape groups and instances included.
std::vector<PluginInfo> shapePlugins();
/// The parameters of the shape's plugin.
const std::vector<ParameterInfo>& shapeParameters(const JsonNode& node);

/// Geometry and flipNormals of a shape, in world space.
Shape readShape(const JsonNode& node, LoadContext& context);

}  // namespace ulam
