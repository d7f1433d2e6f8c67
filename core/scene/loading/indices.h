#pragma once
// Indices of refraction by the names of substances.

#include "core/scene/loading/plugin_table.h"

namespace ulam {

/// An index of refraction as scenes write it: a number, or the name of a substance.
double refractiveIndex(const JsonNode& node);

/// As users see them: an index of refraction may be the name of a substance.
std::vector<ParameterInfo> withNamedIndices(std::vector<ParameterInfo> parameters);

/// parsePlugin of the parameters but for those in `elsewhere`; an index may be a name.
template <Described P>
P parseWithIndices(const JsonNode& node, std::vector<std::string> elsewhere = {}) {
    P parameters;
    ParameterList list;
    parameters.describe(list);
    for (const std::string& key : structuralKeys(node, parameterInfo<P>())) elsewhere.push_back(key);
    for (const auto& parameter : list.parameters()) {
        const auto value = node.find(parameter.name);
        auto* const* member = std::get_if<double*>(&parameter.member);
        if (!value || !value->isString() || !member || !parameter.name.ends_with("_ior")) continue;
        **member = refractiveIndex(*value);
        elsewhere.push_back(parameter.name);
    }
    list.parse(node, elsewhere);
    return parameters;
}

}  // namespace ulam
