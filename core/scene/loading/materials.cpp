#include "core/scene/loading/materials.h"

#include <array>

#include "core/scene/loading/plugin_table.h"

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

double namedIndex(const JsonNode& node) {
    std::vector<std::string> names;
    for (const NamedIndex& index : kIndices) {
        if (index.name == node.string()) return index.ior;
        names.push_back(index.name);
    }
    unknownName("index of refraction", node.string(), names, node.where());
}

using Resolve = std::function<JsonNode(const JsonNode&)>;

template <class B>
Material readPlain(const JsonNode& node, const Resolve&) {
    return {B(parsePlugin<typename B::Parameters>(node)), {}};
}

Material readDielectric(const JsonNode& node, const Resolve&) {
    Dielectric::Parameters parameters;
    ParameterList all, numbers;
    parameters.describe(all);
    std::vector<std::string> named = structuralKeys(node, all.info());
    for (const auto& parameter : all.parameters()) {
        const auto value = node.find(parameter.name);
        const auto* member = std::get_if<double*>(&parameter.member);
        if (value && value->isString() && member) {
            **member = namedIndex(*value);
            named.push_back(parameter.name);
        } else {
            std::visit([&](auto* m) { numbers(parameter.name, *m, parameter.notes); }, parameter.member);
        }
    }
    refuseTextures(node, all.info());
    numbers.parse(node, named);
    return {Dielectric(parameters), {}};
}

/// As users see them: an index may be a name.
std::vector<ParameterInfo> dielectricParameters() {
    auto parameters = parameterInfo<Dielectric::Parameters>();
    for (ParameterInfo& parameter : parameters)
        if (parameter.type == "number") {
            parameter.type = "json";
            parameter.help += "; a number or a name such as \"water\"";
        }
    return parameters;
}

struct NoParameters {
    template <class V>
    void describe(V&) {}
};

Material readTwosided(const JsonNode& node, const Resolve& resolve) {
    parsePlugin<NoParameters>(node);
    std::vector<Bsdf> sides;
    for (const JsonNode& nested : nestedPlugins(node, {})) {
        const JsonNode side = resolve(nested);
        if (pluginName(side) == "twosided") nested.fail("twosided must not hold another twosided");
        const Material material = readMaterial(side, resolve);
        if (std::holds_alternative<Dielectric>(material.front))
            nested.fail("twosided must not hold a BSDF that transmits light");
        sides.push_back(material.front);
    }
    if (sides.empty() || sides.size() > 2)
        node.fail(fmt::format("twosided needs one or two BSDFs, not {}", sides.size()));
    return {sides.front(), sides.back()};
}

const PluginTable<Material(const JsonNode&, const Resolve&)>& table() {
    static const PluginTable<Material(const JsonNode&, const Resolve&)> plugins(
        "bsdf",
        {
            {{"conductor", "smooth metal", parameterInfo<Conductor::Parameters>()}, readPlain<Conductor>},
            {{"dielectric", "smooth interface of two transparent media", dielectricParameters()}, readDielectric},
            {{"diffuse", "Lambertian reflection", parameterInfo<Diffuse::Parameters>()}, readPlain<Diffuse>},
            {{"twosided", "one nested BSDF for both sides, or one for the front and one for the back", {}},
             readTwosided},
        });
    return plugins;
}

}  // namespace

std::vector<PluginInfo> bsdfPlugins() {
    return table().infos();
}

Material readMaterial(const JsonNode& node, const std::function<JsonNode(const JsonNode&)>& resolve) {
    return table().find(node).read(node, resolve);
}

Material defaultMaterial(bool emits) {
    Diffuse::Parameters parameters;
    if (emits) parameters.reflectance = Spectrum(0.0);
    return {Diffuse(parameters), {}};
}

}  // namespace ulam
