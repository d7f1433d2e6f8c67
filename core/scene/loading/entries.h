#pragma once
// The members of a scene dictionary that are plugins.

#include <string>
#include <vector>

#include "core/config/json.h"

namespace ulam {

/// In the order in which they are written; fails at a member that is no plugin.
std::vector<JsonNode> entriesOf(const JsonNode& scene);

/// By which references name an entry.
std::string entryName(const JsonNode& entry);

}  // namespace ulam
