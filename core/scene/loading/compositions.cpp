#include "core/scene/loading/compositions.h"

#include <functional>
#include <numeric>

#include "core/scene/loading/indices.h"

namespace ulam {
namespace {

struct NoParameters {
    template <class V>
    void describe(V&) {}
};

struct MaskParameters {
    double opacity = 0.5;
    template <class V>
    void describe(V& v) {
        v("opacity", opacity, {.help = "1: the nested BSDF alone; 0: nothing is there", .min = 0, .max = 1});
    }
};

struct BlendParameters {
    double weight = 0.5;
    template <class V>
    void describe(V& v) {
        v("weight", weight, {.help = "0: the first BSDF alone; 1: the second", .min = 0, .max = 1});
    }
};

struct MixtureParameters {
    JsonNode weights;
    template <class V>
    void describe(V& v) {
        v("weights", weights,
          {.help = "one number a nested BSDF, in order, with a sum of at most 1; the rest is absorbed",
           .example = "[0.5, 0.3]"});
    }
};

/// What Mitsuba 3.9.1 does to new normals unless told not to.
struct ReliefParameters {
    bool flip = false, shadow = false;
    template <class V>
    void describe(V& v) {
        v("flip_invalid_normals", flip, {.help = "whether normals that face away are turned: only false is supported"});
        v("use_shadowing_function", shadow, {.help = "whether light is attenuated near the horizon of the new normal: only false is supported"});
    }
};

struct BumpmapParameters : ReliefParameters {
    double scale = 1;
    template <class V>
    void describe(V& v) {
        ReliefParameters::describe(v);
        v("scale", scale, {.help = "factor on the heights, which the nested texture holds in units of the scene"});
    }
};

/// `coating`; Mitsuba 0.6's parameters and defaults.
struct CoatingParameters {
    double intIor = 1.5046, extIor = 1.000277, thickness = 1;
    Spectrum sigmaA{0, 0, 0}, specularReflectance{1, 1, 1};
    template <class V>
    void describe(V& v) {
        v("int_ior", intIor, {.help = "index of refraction of the coat; default BK7 glass", .min = 0.1, .max = 10});
        v("ext_ior", extIor,
          {.help = "index of refraction outside; default air; not above the coat's", .min = 0.1, .max = 10});
        v("thickness", thickness, {.help = "of the coat, in the unit of 1 / sigma_a", .min = 0});
        v("sigma_a", sigmaA, {.help = "absorption per unit of thickness", .min = 0});
        v("specular_reflectance", specularReflectance, {.help = "factor on the coat's reflection", .min = 0, .max = 1});
    }
};

struct RoughCoatingParameters : CoatingParameters {
    std::string distribution = "beckmann";
    double alpha = 0.1;
    template <class V>
    void describe(V& v) {
        CoatingParameters::describe(v);
        v("distribution", distribution, {.help = "of the microfacet normals", .choices = {"beckmann", "ggx"}});
        v("alpha", alpha, {.help = "roughness; of Beckmann the root mean square slope", .min = 1e-4, .max = 1});
    }
};

struct NormalmapParameters : ReliefParameters {
    JsonNode normalmap;
    template <class V>
    void describe(V& v) {
        ReliefParameters::describe(v);
        v("normalmap", normalmap,
          {.help = "texture (set its \"raw\") of normals n as colours (n + 1) / 2, in the frame of the shading normal "
                   "(blue) and the direction of growing u (red)",
           .example = R"({"type": "bitmap", "filename": "textures/bumps.png", "raw": true})"});
    }
};

/// The nested BSDFs, read; `textures`: nested textures are the caller's.
std::vector<Material> readNested(const std::vector<JsonNode>& nested, PluginResolver& resolver, int depth) {
    std::vector<Material> materials;
    for (const JsonNode& node : nested) {
        if (depth + 1 > kMaxLayers) node.fail(fmt::format("BSDFs are nested deeper than {}", kMaxLayers));
        materials.push_back(readMaterial(resolver.resolve(node), resolver, depth + 1));
    }
    return materials;
}

/// Both sides of several materials under one layer.
Material layered(const JsonNode& node, const std::vector<Material>& nested,
                 const std::function<Coating(std::vector<Coating>)>& layer) {
    std::vector<Coating> fronts, backs;
    for (const Material& material : nested) {
        fronts.push_back(material.front);
        if (material.back) backs.push_back(*material.back);
    }
    if (backs.empty()) return Material(layer(std::move(fronts)));
    if (backs.size() < nested.size())
        node.fail("of the nested BSDFs some are twosided and some are not",
                  "let all be, or put twosided around the whole");
    return Material(layer(std::move(fronts)), layer(std::move(backs)));
}

/// A delta lobe of a BSDF in a mixture, and what its direction depends on.
struct DeltaLobe {
    Lobe lobe;
    double ior;
    const Relief* relief;
};
void collectDeltaLobes(const Coating& coating, const Relief* relief, std::vector<DeltaLobe>& lobes) {
    if (const auto* varnish = std::get_if<Varnish>(&coating.layer)) {
        if (!varnish->rough) lobes.push_back({Lobe::DeltaReflection, 0, relief});
        return collectDeltaLobes(varnish->nested[0], relief, lobes);
    }
    if (const auto* mixture = std::get_if<Mixture>(&coating.layer)) {
        for (const Coating& part : mixture->parts) collectDeltaLobes(part, relief, lobes);
    } else if (const auto* over = std::get_if<Relief>(&coating.layer)) {
        collectDeltaLobes(over->nested[0], over, lobes);
    } else {
        const Bsdf& bsdf = coating.bsdf();
        if (const auto* glass = std::get_if<Dielectric>(&bsdf)) {
            lobes.push_back({Lobe::DeltaReflection, glass->ior, relief});
            lobes.push_back({Lobe::DeltaTransmission, glass->ior, relief});
        } else if (std::holds_alternative<ThinDielectric>(bsdf)) {
            lobes.push_back({Lobe::DeltaReflection, 1, relief});
            lobes.push_back({Lobe::Null, 1, relief});
        } else if (std::holds_alternative<Null>(bsdf)) {
            lobes.push_back({Lobe::Null, 1, relief});
        } else if (std::holds_alternative<Conductor>(bsdf) || std::holds_alternative<Plastic>(bsdf)) {
            lobes.push_back({Lobe::DeltaReflection, 0, relief});  // on the outside alone, where no index matters
        }
    }
}

/// Delta lobes of one kind are one lobe: they must lead the same way.
void checkDeltaLobes(const JsonNode& node, const Coating& coating) {
    std::vector<DeltaLobe> lobes;
    collectDeltaLobes(coating, nullptr, lobes);
    for (const DeltaLobe& a : lobes)
        for (const DeltaLobe& b : lobes) {
            if (a.lobe != b.lobe) continue;
            if (a.relief != b.relief)
                node.fail("two nested BSDFs are specular under different bump or normal maps",
                          "put one map around the whole");
            if (a.ior != b.ior && a.ior != 0 && b.ior != 0)
                node.fail("two nested BSDFs refract with different indices");
        }
}

Material mixed(const JsonNode& node, const std::vector<Material>& nested,
               const std::function<Coating(std::vector<Coating>)>& layer) {
    Material material = layered(node, nested, layer);
    for (const Coating* side : {&material.front, material.back ? &*material.back : &material.front})
        checkDeltaLobes(node, *side);
    return material;
}

/// A number in [0,1] that a texture may stand for, the plugin's only parameter.
template <class P>
Share readShare(const JsonNode& node, PluginResolver& resolver, const PluginInfo& info, double P::*member) {
    const auto textured = texturedParameters(node, info, resolver);
    if (textured.empty()) return {parsePlugin<P>(node).*member, kNone, false};
    parseOtherParameters<P>(node, {textured.front().name});
    return {1, textured.front().texture, false};
}

Share rest(Share share) {
    share.rest = true;
    return share;
}

/// The texture and the BSDFs that a relief's dictionary holds.
struct ReliefParts {
    std::optional<JsonNode> texture;
    std::vector<JsonNode> bsdfs;
};
ReliefParts reliefParts(const JsonNode& node, const PluginInfo& info, PluginResolver& resolver) {
    ReliefParts parts;
    for (const JsonNode& nested : nestedPlugins(node, info.parameters)) {
        if (!resolver.isTexture(nested)) {
            parts.bsdfs.push_back(nested);
            continue;
        }
        if (parts.texture) nested.fail(fmt::format("{} holds one texture, and another stands before", info.name));
        parts.texture = nested;
    }
    if (parts.bsdfs.size() != 1) node.fail(fmt::format("{} needs one BSDF, not {}", info.name, parts.bsdfs.size()));
    return parts;
}

/// The integrals over a rough coat are written for light that enters a denser one; a smooth one follows suit.
void checkCoatIndex(const JsonNode& node, const CoatingParameters& p) {
    if (!(p.intIor > p.extIor)) node.fail("the coat must have the higher index of refraction");
}

Material varnished(const JsonNode& node, const CoatingParameters& p, std::shared_ptr<const RoughCoat> rough,
                   PluginResolver& resolver, int depth) {
    const auto nested = nestedPlugins(node, parameterInfo<RoughCoatingParameters>());
    if (nested.size() != 1) node.fail(fmt::format("{} needs one BSDF, not {}", pluginName(node), nested.size()));
    const std::vector<Material> inside = readNested(nested, resolver, depth);
    forEachBsdf(inside[0].front, [&](const Bsdf& any) {
        if (dispatch(any, [](const auto& bsdf) { return bsdf.transmits; }))
            nested[0].fail("what is coated must not transmit light");
    });
    Material material = layered(node, inside, [&](std::vector<Coating> below) {
        return Coating{
            Varnish{p.intIor / p.extIor, p.sigmaA * p.thickness, p.specularReflectance, rough, std::move(below)}};
    });
    checkDeltaLobes(node, material.front);
    return material;
}

Material relieved(const JsonNode& node, const ReliefParts& parts, Relief relief, PluginResolver& resolver, int depth) {
    return layered(node, readNested(parts.bsdfs, resolver, depth), [&](std::vector<Coating> nested) {
        relief.nested = std::move(nested);
        return Coating{relief};
    });
}

}  // namespace

PluginInfo twosidedInfo() {
    return {"twosided", "one nested BSDF for both sides, or one for the front and one for the back", {}, {}};
}
PluginInfo maskInfo() {
    return {"mask", "one nested BSDF, partly cut out", parameterInfo<MaskParameters>(), {"opacity"}};
}
PluginInfo blendInfo() {
    return {"blendbsdf", "two nested BSDFs, weighted", parameterInfo<BlendParameters>(), {"weight"}};
}
PluginInfo mixtureInfo() {
    return {"mixturebsdf", "several nested BSDFs, weighted (Mitsuba 0.6)", parameterInfo<MixtureParameters>(), {}};
}
PluginInfo bumpmapInfo() {
    return {"bumpmap",
            "one nested BSDF with the normals of a nested texture's heights",
            parameterInfo<BumpmapParameters>(),
            {}};
}
PluginInfo coatingInfo() {
    return {"coating",
            "smooth dielectric coat over one nested BSDF (Mitsuba 0.6)",
            withNamedIndices(parameterInfo<CoatingParameters>()),
            {}};
}
PluginInfo roughCoatingInfo() {
    return {"roughcoating",
            "rough dielectric coat over one nested BSDF (Mitsuba 0.6)",
            withNamedIndices(parameterInfo<RoughCoatingParameters>()),
            {}};
}
PluginInfo normalmapInfo() {
    return {
        "normalmap", "one nested BSDF with the normals that a texture holds", parameterInfo<NormalmapParameters>(), {}};
}

Material readTwosided(const JsonNode& node, PluginResolver& resolver, int depth) {
    parsePlugin<NoParameters>(node);
    const std::vector<JsonNode> nested = nestedPlugins(node, {});
    if (nested.empty() || nested.size() > 2)
        node.fail(fmt::format("twosided needs one or two BSDFs, not {}", nested.size()));
    for (const JsonNode& side : nested)
        if (pluginName(resolver.resolve(side)) == "twosided") side.fail("twosided must not hold another twosided");
    const std::vector<Material> sides = readNested(nested, resolver, depth);
    for (size_t i = 0; i < sides.size(); ++i) {
        if (sides[i].back) nested[i].fail("twosided must not hold another twosided");
        forEachBsdf(sides[i].front, [&](const Bsdf& any) {
            if (dispatch(any, [](const auto& bsdf) { return bsdf.transmits; }))
                nested[i].fail("twosided must not hold a BSDF that transmits light");
        });
    }
    return Material(sides.front().front, sides.back().front);
}

Material readMask(const JsonNode& node, PluginResolver& resolver, int depth) {
    const Share opacity = readShare(node, resolver, maskInfo(), &MaskParameters::opacity);
    const auto nested = nestedPlugins(node, maskInfo().parameters);
    if (nested.size() != 1) node.fail(fmt::format("mask needs one BSDF, not {}", nested.size()));
    return mixed(node, readNested(nested, resolver, depth), [&](std::vector<Coating> parts) {
        parts.insert(parts.begin(), Coating{TexturedBsdf{Null(Null::Parameters()), {}}});
        return Coating{Mixture{std::move(parts), {rest(opacity), opacity}}};
    });
}

Material readBlend(const JsonNode& node, PluginResolver& resolver, int depth) {
    const Share weight = readShare(node, resolver, blendInfo(), &BlendParameters::weight);
    const auto nested = nestedPlugins(node, blendInfo().parameters);
    if (nested.size() != 2) node.fail(fmt::format("blendbsdf needs two BSDFs, not {}", nested.size()));
    return mixed(node, readNested(nested, resolver, depth), [&](std::vector<Coating> parts) {
        return Coating{Mixture{std::move(parts), {rest(weight), weight}}};
    });
}

Material readMixture(const JsonNode& node, PluginResolver& resolver, int depth) {
    const JsonNode given = parsePlugin<MixtureParameters>(node).weights;
    if (given.isNull()) node.at("weights");  // fails: it is missing
    const auto nested = nestedPlugins(node, mixtureInfo().parameters);
    if (nested.empty() || nested.size() > Mixture::kMaxParts)
        node.fail(fmt::format("mixturebsdf needs one to {} BSDFs, not {}", Mixture::kMaxParts, nested.size()));
    const std::vector<double> weights = given.numbers(nested.size());
    for (const double weight : weights)
        if (!(weight >= 0)) given.expected("weights of at least 0");
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    if (sum > 1 + 1e-6) given.fail(fmt::format("the weights add up to {:g}, more than 1", sum));
    return mixed(node, readNested(nested, resolver, depth), [&](std::vector<Coating> parts) {
        Mixture mixture{std::move(parts), {}};
        for (const double weight : weights) mixture.shares.push_back({weight, kNone, false});
        return Coating{std::move(mixture)};
    });
}

void requireSupported(const ReliefParameters& p, const JsonNode& node) {
    for (const auto& [name, given] : {std::pair("flip_invalid_normals", p.flip), std::pair("use_shadowing_function", p.shadow)})
        if (given) node.at(name).fail(fmt::format("{} is not supported", inQuotes(name)), "set it to false");
}

Material readBumpmap(const JsonNode& node, PluginResolver& resolver, int depth) {
    const auto p = parsePlugin<BumpmapParameters>(node);
    requireSupported(p, node);
    const ReliefParts parts = reliefParts(node, bumpmapInfo(), resolver);
    if (!parts.texture) node.fail("bumpmap needs a texture of heights");
    ParameterInfo heights;
    heights.name = parts.texture->key();
    return relieved(node, parts, {Relief::Kind::Heights, resolver.texture(*parts.texture, heights), p.scale, {}},
                    resolver, depth);
}

Material readNormalmap(const JsonNode& node, PluginResolver& resolver, int depth) {
    requireSupported(parsePlugin<NormalmapParameters>(node), node);
    const JsonNode texture = node.at("normalmap");
    if (!isPlugin(texture) || !resolver.isTexture(texture)) texture.expected("a texture");
    const ReliefParts parts = reliefParts(node, normalmapInfo(), resolver);
    if (parts.texture) parts.texture->fail("normalmap holds one texture, called \"normalmap\"");
    ParameterInfo normals;
    normals.name = "normalmap";
    normals.min = 0, normals.max = 1;
    return relieved(node, parts, {Relief::Kind::Normals, resolver.texture(texture, normals), 1, {}}, resolver, depth);
}

Material readCoating(const JsonNode& node, PluginResolver& resolver, int depth) {
    const auto p = parseWithIndices<CoatingParameters>(node);
    checkCoatIndex(node, p);
    return varnished(node, p, nullptr, resolver, depth);
}

Material readRoughCoating(const JsonNode& node, PluginResolver& resolver, int depth) {
    const auto p = parseWithIndices<RoughCoatingParameters>(node);
    checkCoatIndex(node, p);
    const MicrofacetDistribution distribution{MicrofacetDistribution::kindOf(p.distribution), p.alpha, p.alpha};
    return varnished(
        node, p,
        std::make_shared<RoughCoat>(RoughCoat{distribution, RoughTransmittance(distribution, p.intIor / p.extIor)}),
        resolver, depth);
}

}  // namespace ulam
