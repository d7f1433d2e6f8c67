#include "core/scene/loading/indices.h"

#include <array>

namespace ulam {
namespace {

struct NamedIndex {
    const char* name;
    double ior;
};

// Refractive indices near 589 nm under the names that Mitsuba 3 gives them (E. Hecht, Optics, 4th ed.).
constexpr std::array kIndices{
    NamedIndex{"vacuum", 1.0},      NamedIndex{"helium", 1.000036},        NamedIndex{"hydrogen", 1.000132},
    NamedIndex{"air", 1.000277},    NamedIndex{"carbon dioxide", 1.00045}, NamedIndex{"water", 1.333},
    NamedIndex{"acetone", 1.36},    NamedIndex{"ethanol", 1.361},          NamedIndex{"carbon tetrachloride", 1.461},
    NamedIndex{"glycerol", 1.4729}, NamedIndex{"benzene", 1.501},          NamedIndex{"silicone oil", 1.52045},
    NamedIndex{"bromine", 1.661},   NamedIndex{"water ice", 1.31},         NamedIndex{"fused quartz", 1.458},
    NamedIndex{"pyrex", 1.47},      NamedIndex{"acrylic glass", 1.49},     NamedIndex{"polypropylene", 1.49},
    NamedIndex{"bk7", 1.5046},      NamedIndex{"sodium chloride", 1.544},  NamedIndex{"amber", 1.55},
    NamedIndex{"pet", 1.575},       NamedIndex{"diamond", 2.419},
};

}  // namespace

double refractiveIndex(const JsonNode& node) {
    if (!node.isString()) return node.number();
    std::vector<std::string> names;
    for (const NamedIndex& index : kIndices) {
        if (index.name == node.string()) return index.ior;
        names.push_back(index.name);
    }
    unknownName("index of refraction", node.string(), names, node.where());
}

std::vector<ParameterInfo> withNamedIndices(std::vector<ParameterInfo> parameters) {
    for (ParameterInfo& parameter : parameters)
        if (parameter.name == "int_ior" || parameter.name == "ext_ior") {
            parameter.type = "json";
            parameter.help += "; a number or a name such as \"water\"";
        }
    return parameters;
}

}  // namespace ulam
