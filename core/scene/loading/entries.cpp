#include "core/scene/loading/entries.h"

#include "core/scene/loading/plugin_table.h"

namespace ulam {

std::vector<JsonNode> entriesOf(const JsonNode& scene) {
    std::vector<JsonNode> result;
    for (const auto& [key, member] : scene.members()) {
        if (key == "type" || key == "id" || key == "$schema" || key == "$substitutions") continue;
        if (!isPlugin(member)) member.expected("an object with a \"type\"");
        result.push_back(member);
    }
    return result;
}

std::string entryName(const JsonNode& entry) {
    const auto own = entry.find("id");
    return own ? own->string() : entry.key();
}

}  // namespace ulam
