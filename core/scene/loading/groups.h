#pragma once
// Shape groups and their instances.

#include "core/scene/plugins.h"
#include "core/scene/shape.h"

#include "core/config/json.h"

namespace ulam {

/// `shapegroup` and `instance`.
std::vector<PluginInfo> groupPlugins();

/// Makes a group of its members: their meshes come first, and are shared by all instances from now on.
std::vector<Shape> makeGroup(std::vector<Shape> members);

/// The shapes of an instance, in world space.
std::vector<Shape> readInstance(const JsonNode& node, const std::vector<Shape>& group);

}  // namespace ulam
