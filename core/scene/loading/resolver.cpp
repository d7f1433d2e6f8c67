#include "core/scene/loading/resolver.h"

#include <algorithm>

namespace ulam {

std::vector<TexturedParameter> texturedParameters(const JsonNode& node, const PluginInfo& info, PluginResolver& resolver) {
    std::vector<TexturedParameter> result;
    for (const ParameterInfo& parameter : info.parameters) {
        const auto value = node.find(parameter.name);
        if (!value || !isPlugin(*value) || pluginName(*value) == "rgb") continue;
        const auto& names = info.textured;
        if (std::find(names.begin(), names.end(), parameter.name) == names.end())
            value->fail(fmt::format("{} of {} takes no texture", inQuotes(parameter.name), inQuotes(info.name)),
                        names.empty() ? "" : fmt::format("{} may be textured", listInQuotes(names)));
        result.push_back({parameter.name, resolver.texture(*value, parameter)});
    }
    return result;
}

}  // namespace ulam
