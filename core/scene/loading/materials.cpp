#include "core/scene/loading/materials.h"

#include "core/scene/loading/compositions.h"
#include "core/scene/loading/indices.h"

#include <algorithm>
#include <array>

namespace ulam {
namespace {

/// As users see them.
template <class B>
PluginInfo infoOf(const char* name, const char* summary) {
    PluginInfo info{name, summary, withNamedIndices(parameterInfo<typename B::Parameters>()), {}};
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
Material readPlain(const JsonNode& node, PluginResolver& resolver, int) {
    const PluginInfo info = infoOf<B>(pluginName(node).c_str(), "");
    const auto textured = texturedParameters(node, info, resolver);
    std::vector<std::string> elsewhere;
    for (const TexturedParameter& t : textured) elsewhere.push_back(t.name);
    auto parameters = parseWithIndices<typename B::Parameters>(node, std::move(elsewhere));
    checkRoughness(node);
    if constexpr (std::is_base_of_v<MetalParameters, typename B::Parameters>) useMetal(parameters, node);
    checkIndex(node);
    TexturedBsdf coating{made<B>(parameters, node), {}};
    for (const TexturedParameter& t : textured) {
        int member = 0;
        auto bind = [&](const char* name, auto) {
            if (t.name == name) coating.bindings.push_back({member, t.texture});
            ++member;
        };
        B::textured(bind);
    }
    return Material(Coating{std::move(coating)});
}

const PluginTable<Material(const JsonNode&, PluginResolver&, int)>& materialTable() {
    static const PluginTable<Material(const JsonNode&, PluginResolver&, int)> plugins(
        "bsdf", {
                    {blendInfo(), readBlend},
                    {bumpmapInfo(), readBumpmap},
                    {coatingInfo(), readCoating},
                    {infoOf<Conductor>("conductor", "smooth metal"), readPlain<Conductor>},
                    {infoOf<Dielectric>("dielectric", "smooth interface of two transparent media"), readPlain<Dielectric>},
                    {infoOf<Diffuse>("diffuse", "Lambertian reflection"), readPlain<Diffuse>},
                    {maskInfo(), readMask},
                    {mixtureInfo(), readMixture},
                    {normalmapInfo(), readNormalmap},
                    {infoOf<Null>("null", "nothing: light goes straight through"), readPlain<Null>},
                    {infoOf<Phong>("phong", "diffuse base with a cosine lobe"), readPlain<Phong>},
                    {infoOf<Plastic>("plastic", "smooth transparent coat over a diffuse base"), readPlain<Plastic>},
                    {infoOf<Principled>("principled", "Disney's BSDF, from plastic to metal and glass"), readPlain<Principled>},
                    {roughCoatingInfo(), readRoughCoating},
                    {infoOf<RoughConductor>("roughconductor", "rough metal"), readPlain<RoughConductor>},
                    {infoOf<RoughDielectric>("roughdielectric", "rough interface of two transparent media"), readPlain<RoughDielectric>},
                    {infoOf<RoughDiffuse>("roughdiffuse", "Lambertian facets: clay, plaster, sand"), readPlain<RoughDiffuse>},
                    {infoOf<RoughPlastic>("roughplastic", "rough transparent coat over a diffuse base"), readPlain<RoughPlastic>},
                    {infoOf<ThinDielectric>("thindielectric", "pane of glass without thickness"), readPlain<ThinDielectric>},
                    {twosidedInfo(), readTwosided},
                    {infoOf<Ward>("ward", "diffuse base with anisotropic gloss"), readPlain<Ward>},
                });
    return plugins;
}

}  // namespace

std::vector<PluginInfo> bsdfPlugins() {
    return materialTable().infos();
}

Material readMaterial(const JsonNode& node, PluginResolver& resolver, int depth) {
    return materialTable().find(node).read(node, resolver, depth);
}

Material defaultMaterial(bool emits) {
    Diffuse::Parameters parameters;
    if (emits) parameters.reflectance = Spectrum(0.0);
    return Material(Coating{TexturedBsdf{Diffuse(parameters), {}}});
}

}  // namespace ulam
