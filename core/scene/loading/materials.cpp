#include "core/scene/loading/materials.h"

#include <algorithm>
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

double namedIndex(const JsonNode& node) {
    std::vector<std::string> names;
    for (const NamedIndex& index : kIndices) {
        if (index.name == node.string()) return index.ior;
        names.push_back(index.name);
    }
    unknownName("index of refraction", node.string(), names, node.where());
}

/// As users see them: an index of refraction may be the name of a substance.
template <class B>
PluginInfo infoOf(const char* name, const char* summary) {
    PluginInfo info{name, summary, parameterInfo<typename B::Parameters>(), {}};
    for (ParameterInfo& parameter : info.parameters)
        if (parameter.name == "int_ior" || parameter.name == "ext_ior") {
            parameter.type = "json";
            parameter.help += "; a number or a name such as \"water\"";
        }
    auto list = [&](const char* parameter, auto) {
        if (info.textured.empty() || info.textured.back() != parameter) info.textured.push_back(parameter);
    };
    B::textured(list);
    return info;
}

/// alpha, or both alpha_u and alpha_v.
void checkRoughness(const JsonNode& node) {
    const auto alpha = node.find("alpha"), u = node.find("alpha_u"), v = node.find("alpha_v");
    if (alpha && (u || v)) (u ? *u : *v).fail("a roughness is alpha, or alpha_u and alpha_v, not both");
    if (bool(u) != bool(v)) (u ? *u : *v).fail(fmt::format("alpha_u and alpha_v come together; {} is missing", u ? "alpha_v" : "alpha_u"));
    for (const auto& given : {u, v})
        if (given && given->isNumber() && given->number() < 1e-4) given->expected("a roughness from 0.0001 to 1", "a smooth BSDF has none");
}

/// The optical constants of a named metal.
void useMetal(MetalParameters& p, const JsonNode& node) {
    const auto material = node.find("material");
    if (!material || p.material == "none") return;
    for (const char* constant : {"eta", "k"})
        if (const auto given = node.find(constant)) given->fail(fmt::format("a metal is a material, or eta and k, not both; the material is {}", inQuotes(p.material)));
    p.eta = findMetal(p.material)->eta;
    p.k = findMetal(p.material)->k;
}

/// principled says its index of refraction in two ways.
void checkIndex(const JsonNode& node) {
    const auto eta = node.find("eta"), specular = node.find("specular");
    if (eta && specular) specular->fail("an index of refraction is eta or specular, not both");
}

/// Parameters that do not go together are refused at the BSDF's place.
template <class B>
B made(const typename B::Parameters& parameters, const JsonNode& node) {
    try {
        return B(parameters);
    } catch (const Error& error) {
        node.fail(error.what());
    }
}

template <class B>
Material readPlain(const JsonNode& node, PluginResolver& resolver) {
    const PluginInfo info = infoOf<B>(pluginName(node).c_str(), "");
    const auto textured = texturedParameters(node, info, resolver);
    typename B::Parameters parameters;
    ParameterList list;
    parameters.describe(list);
    std::vector<std::string> elsewhere = structuralKeys(node, info.parameters);
    for (const TexturedParameter& t : textured) elsewhere.push_back(t.name);
    for (const auto& parameter : list.parameters()) {
        const auto value = node.find(parameter.name);
        auto* const* member = std::get_if<double*>(&parameter.member);
        if (!value || !value->isString() || !member || !parameter.name.ends_with("_ior")) continue;
        **member = namedIndex(*value);
        elsewhere.push_back(parameter.name);
    }
    list.parse(node, elsewhere);
    checkRoughness(node);
    if constexpr (std::is_base_of_v<MetalParameters, typename B::Parameters>) useMetal(parameters, node);
    checkIndex(node);
    Coating coating{made<B>(parameters, node), {}};
    for (const TexturedParameter& t : textured) {
        int member = 0;
        auto bind = [&](const char* name, auto) {
            if (t.name == name) coating.bindings.push_back({member, t.texture});
            ++member;
        };
        B::textured(bind);
    }
    return Material(std::move(coating));
}

struct NoParameters {
    template <class V>
    void describe(V&) {}
};

Material readTwosided(const JsonNode& node, PluginResolver& resolver) {
    parsePlugin<NoParameters>(node);
    std::vector<Coating> sides;
    for (const JsonNode& nested : nestedPlugins(node, {})) {
        const JsonNode side = resolver.resolve(nested);
        if (pluginName(side) == "twosided") nested.fail("twosided must not hold another twosided");
        Material material = readMaterial(side, resolver);
        if (material.masked || dispatch(material.front.bsdf, [](const auto& bsdf) { return bsdf.transmits; }))
            nested.fail("twosided must not hold a BSDF that transmits light");
        sides.push_back(std::move(material.front));
    }
    if (sides.empty() || sides.size() > 2)
        node.fail(fmt::format("twosided needs one or two BSDFs, not {}", sides.size()));
    return Material(sides.front(), sides.back());
}

struct MaskParameters {
    double opacity = 0.5;
    template <class V>
    void describe(V& v) {
        v("opacity", opacity, {.help = "1: the nested BSDF alone; 0: nothing is there", .min = 0, .max = 1});
    }
};

PluginInfo maskInfo() {
    return {"mask", "one nested BSDF, partly cut out", parameterInfo<MaskParameters>(), {"opacity"}};
}

Material readMask(const JsonNode& node, PluginResolver& resolver) {
    const PluginInfo info = maskInfo();
    const auto textured = texturedParameters(node, info, resolver);
    const auto nested = nestedPlugins(node, info.parameters);
    if (nested.size() != 1) node.fail(fmt::format("mask needs one BSDF, not {}", nested.size()));
    const JsonNode inside = resolver.resolve(nested.front());
    if (pluginName(inside) == "mask") nested.front().fail("mask must not hold another mask");
    Material material = readMaterial(inside, resolver);
    if (textured.empty())
        material.mask(parsePlugin<MaskParameters>(node).opacity, kNone);
    else
        material.mask(parseOtherParameters<MaskParameters>(node, {textured.front().name}).opacity, textured.front().texture);
    return material;
}

const PluginTable<Material(const JsonNode&, PluginResolver&)>& table() {
    static const PluginTable<Material(const JsonNode&, PluginResolver&)> plugins(
        "bsdf", {
                    {infoOf<Conductor>("conductor", "smooth metal"), readPlain<Conductor>},
                    {infoOf<Dielectric>("dielectric", "smooth interface of two transparent media"), readPlain<Dielectric>},
                    {infoOf<Diffuse>("diffuse", "Lambertian reflection"), readPlain<Diffuse>},
                    {maskInfo(), readMask},
                    {infoOf<Null>("null", "nothing: light goes straight through"), readPlain<Null>},
                    {infoOf<Phong>("phong", "diffuse base with a cosine lobe"), readPlain<Phong>},
                    {infoOf<Plastic>("plastic", "smooth transparent coat over a diffuse base"), readPlain<Plastic>},
                    {infoOf<Principled>("principled", "Disney's BSDF, from plastic to metal and glass"), readPlain<Principled>},
                    {infoOf<RoughConductor>("roughconductor", "rough metal"), readPlain<RoughConductor>},
                    {infoOf<RoughDielectric>("roughdielectric", "rough interface of two transparent media"), readPlain<RoughDielectric>},
                    {infoOf<RoughDiffuse>("roughdiffuse", "Lambertian facets: clay, plaster, sand"), readPlain<RoughDiffuse>},
                    {infoOf<RoughPlastic>("roughplastic", "rough transparent coat over a diffuse base"), readPlain<RoughPlastic>},
                    {infoOf<ThinDielectric>("thindielectric", "pane of glass without thickness"), readPlain<ThinDielectric>},
                    {{"twosided", "one nested BSDF for both sides, or one for the front and one for the back", {}, {}},
                     readTwosided},
                    {infoOf<Ward>("ward", "diffuse base with anisotropic gloss"), readPlain<Ward>},
                });
    return plugins;
}

}  // namespace

std::vector<PluginInfo> bsdfPlugins() {
    return table().infos();
}

Material readMaterial(const JsonNode& node, PluginResolver& resolver) {
    return table().find(node).read(node, resolver);
}

double refractiveIndex(const JsonNode& node) { return node.isString() ? namedIndex(node) : node.number(); }

Material defaultMaterial(bool emits) {
    Diffuse::Parameters parameters;
    if (emits) parameters.reflectance = Spectrum(0.0);
    return Material({Diffuse(parameters), {}});
}

}  // namespace ulam
