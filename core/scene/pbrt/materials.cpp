#include "core/scene/pbrt/materials.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/config/suggest.h"
#include "core/scene/bsdfs/metals.h"
#include "core/scene/loading/plugin_table.h"
#include "core/scene/loading/transform.h"

namespace ulam::pbrt {
namespace {

constexpr double kSmooth = 1e-3;  // pbrt takes what is less rough for smooth
constexpr int kDeepestMixture = 16;

Json twosided(Json bsdf) {
    return {{"type", "twosided"}, {"bsdf", std::move(bsdf)}};
}

}  // namespace

Materials::Materials(Dictionary& dictionary, Textures& textures) : dictionary_(dictionary), textures_(textures) {
    definitions_.push_back({"diffuse", "", {}});
}

size_t Materials::add(MaterialDefinition definition) {
    if (!definition.name.empty() && !named_.emplace(definition.name, definitions_.size()).second)
        refuse(definition.parameters.place(), fmt::format("another material is called {}", inQuotes(definition.name)));
    definitions_.push_back(std::move(definition));
    return definitions_.size() - 1;
}

size_t Materials::indexOf(const MaterialUse& use) const {
    if (use.name.empty()) return use.index;
    if (const auto found = named_.find(use.name); found != named_.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [name, index] : named_) names.push_back(name);
    unknownName("material", use.name, names, use.place.text());
}

const Materials::Converted& Materials::convert(size_t index, Parametrization parametrization) {
    // Without textures the parametrisation does not matter.
    const auto any = converted_.lower_bound({index, Parametrization::Same});
    if (any != converted_.end() && any->first.first == index && !any->second.textured) return any->second;
    if (const auto known = converted_.find({index, parametrization}); known != converted_.end()) return known->second;
    const MaterialDefinition& material = definitions_[index];
    const auto outer = std::tuple(entry_, parametrization_, textured_);
    if (++depth_ > kDeepestMixture)
        refuse(material.parameters.place(),
               fmt::format("mixtures are nested deeper than {}, or hold themselves", kDeepestMixture));
    entry_ = dictionary_.name(material.name.empty() ? "material" : material.name);
    parametrization_ = parametrization;
    textured_ = false;
    Json plugin = bsdf(material);
    material.parameters.finish();
    const Converted converted{entry_, textured_};
    const Place place = material.parameters.place();
    dictionary_.add(entry_, std::move(plugin), place);
    std::tie(entry_, parametrization_, textured_) = outer;
    --depth_;
    return converted_[{index, parametrization}] = converted;
}

Json Materials::use(const MaterialUse& use, Parametrization parametrization, const std::optional<Texture>& alpha) {
    const size_t index = indexOf(use);
    if (index == 0 && !alpha) return twosided({{"type", "diffuse"}});
    Json inside = index == 0 ? twosided({{"type", "diffuse"}})
                             : Json{{"type", "ref"}, {"id", convert(index, parametrization).entry}};
    if (!alpha || (alpha->isConstant() && alpha->first.x >= 1)) return inside;
    Json mask = {{"type", "mask"}, {"opacity", textures_.use(*alpha, parametrization)}, {"bsdf", std::move(inside)}};
    const auto [entry, isNew] = masks_.try_emplace(mask.dump());
    if (isNew) {
        entry->second = dictionary_.name("mask");
        dictionary_.add(entry->second, std::move(mask), alpha->place);
    }
    return {{"type", "ref"}, {"id", entry->second}};
}

bool Materials::isTextured(const MaterialUse& use) {
    const size_t index = indexOf(use);
    return index != 0 && convert(index, Parametrization::Same).textured;
}

void Materials::addUnused() {
    for (const auto& [name, index] : named_) {
        const auto any = converted_.lower_bound({index, Parametrization::Same});
        if (any == converted_.end() || any->first.first != index) convert(index, Parametrization::Same);
    }
}

Json Materials::value(const Texture& texture) {
    textured_ |= !texture.isConstant();
    return textures_.use(texture, parametrization_);
}

void Materials::nearest(const Parameters& p, const std::string& bsdf, const std::string& difference) {
    dictionary_.substitute(fmt::format("the {} at {} is written as the nearest, {}: {}", p.owner(), p.place().text(),
                                       inQuotes(bsdf), difference));
}

Json Materials::magenta() const {
    return twosided({{"type", "diffuse"}, {"reflectance", {1, 0, 1}}});
}

Json Materials::bsdf(const MaterialDefinition& material) {
    struct Reader {
        const char* type;
        Json (Materials::*read)(const Parameters&);
    };
    static constexpr std::array<Reader, 8> kReaders{{{"coatedconductor", &Materials::coatedConductor},
                                                     {"coateddiffuse", &Materials::coatedDiffuse},
                                                     {"conductor", &Materials::conductor},
                                                     {"dielectric", &Materials::dielectric},
                                                     {"diffuse", &Materials::diffuse},
                                                     {"interface", &Materials::nothing},
                                                     {"mix", &Materials::mix},
                                                     {"thindielectric", &Materials::thinDielectric}}};
    const Parameters& p = material.parameters;
    std::vector<std::string> names;
    for (const Reader& reader : kReaders) {
        names.emplace_back(reader.type);
        if (material.type != reader.type) continue;
        for (const char* detail : {"displacement", "normalmap"})
            if (const Parameter* given = p.find(detail, {"texture", "string", "float"}))
                dictionary_.unsupported(fmt::format("{} of {}", inQuotes(detail), p.owner()), given->place, {},
                                        "the surface stays smooth");
        return (this->*reader.read)(p);
    }
    dictionary_.unknown("material", material.type, names, p.place(), "magenta takes its place");
    for (const Parameter& parameter : p.all()) p.ignore({parameter.name});
    return magenta();
}

Json Materials::nothing(const Parameters&) {
    return {{"type", "null"}};
}

Json Materials::diffuse(const Parameters& p) {
    return twosided({{"type", "diffuse"}, {"reflectance", value(textures_.colour(p, "reflectance", Spectrum(0.5)))}});
}

/// α of the microfacets along u and v.
Materials::Roughness Materials::roughness(const Parameters& p, const std::string& prefix) {
    const Texture both = textures_.number(p, prefix + "roughness", 0);
    const auto one = [&](const char* name) {
        const std::string own = prefix + name;
        return p.find(own, {"float", "texture"}) ? textures_.number(p, own, 0) : both;
    };
    Roughness result{one("uroughness"), one("vroughness")};
    const bool remapped = p.flag("remaproughness", true);
    for (Texture* alpha : {&result.u, &result.v}) {
        if (alpha->isConstant()) {
            if (!(alpha->first.x >= 0)) refuse(alpha->place, fmt::format("a roughness of {} is below 0", p.owner()));
            if (remapped) alpha->first = Spectrum(std::sqrt(alpha->first.x));
        } else if (remapped) {
            dictionary_.unsupported(fmt::format("a texture for a roughness of {} that is remapped", p.owner()),
                                    p.place(), "with \"bool remaproughness\" false it is",
                                    "a roughness of 0.5 takes its place");
            *alpha = {};
            alpha->first = Spectrum(std::sqrt(0.5));
        }
    }
    result.isSmooth =
        result.u.isConstant() && result.v.isConstant() && std::max(result.u.first.x, result.v.first.x) < kSmooth;
    return result;
}

void Materials::setRoughness(Json& bsdf, const Roughness& roughness) {
    const auto alpha = [&](Texture texture) {
        if (texture.isConstant()) texture.first = Spectrum(std::clamp(texture.first.x, 1e-4, 1.0));
        return value(texture);
    };
    const Json u = alpha(roughness.u), v = alpha(roughness.v);
    bsdf["distribution"] = "ggx";
    if (u == v) {
        bsdf["alpha"] = u;
    } else {
        bsdf["alpha_u"] = u;
        bsdf["alpha_v"] = v;
    }
}

/// The one roughness that coats have here.
double Materials::coatAlpha(const Parameters& p, const Roughness& rough, std::string& difference) {
    if (!rough.u.isConstant() || !rough.v.isConstant()) {
        dictionary_.unsupported(fmt::format("a texture for a roughness of {}", p.owner()), p.place(), {},
                                "a roughness of 0.5 takes its place");
        return std::sqrt(0.5);
    }
    const double u = rough.u.first.x, v = rough.v.first.x;
    if (u != v) difference += ", its roughness is the same in all directions";
    return std::clamp(std::sqrt(u * v), 1e-4, 1.0);
}

Json Materials::coatedDiffuse(const Parameters& p) {
    const Roughness rough = roughness(p, "");
    Json bsdf = {{"type", rough.isSmooth ? "plastic" : "roughplastic"},
                 {"diffuse_reflectance", value(textures_.colour(p, "reflectance", Spectrum(0.5)))},
                 {"int_ior", index(p, "eta", 1.5, dictionary_)},
                 {"ext_ior", 1},
                 {"nonlinear", true}};
    std::string difference = "the coat absorbs nothing";
    textures_.number(p, "thickness", 0.01);
    const Texture albedo = textures_.colour(p, "albedo", Spectrum(0.0));
    if (!albedo.isConstant() || !isBlack(albedo.first)) difference += " and scatters nothing";
    textures_.number(p, "g", 0);
    p.ignore({"maxdepth", "nsamples", "twosided"});
    if (!rough.isSmooth) {
        bsdf["alpha"] = coatAlpha(p, rough, difference);
        bsdf["distribution"] = "ggx";
    }
    nearest(p, bsdf["type"], difference);
    return twosided(std::move(bsdf));
}

Json Materials::metalBsdf(const Parameters& p, const std::string& prefix) {
    const Roughness rough = roughness(p, prefix);
    Json bsdf = {{"type", rough.isSmooth ? "conductor" : "roughconductor"}};
    if (!rough.isSmooth) setRoughness(bsdf, rough);
    if (const Parameter* given = p.find("reflectance", {"rgb", "spectrum", "texture"})) {
        for (const char* other : {"eta", "k"})
            if (p.find(prefix + other, {"rgb", "spectrum"}))
                refuse(given->place,
                       fmt::format("a metal is its reflectance, or eta and k, not both, in {}", p.owner()));
        const Texture reflectance = textures_.colour(p, "reflectance", Spectrum(0.5));
        if (reflectance.isConstant()) {
            // The metal with η = 1 that reflects this at normal incidence.
            Spectrum k;
            for (int c = 0; c < 3; ++c) {
                const double r = std::clamp(reflectance.first[c], 0.0, 0.9999);
                k[c] = 2 * std::sqrt(r / (1 - r));
            }
            bsdf["eta"] = 1;
            bsdf["k"] = colourJson(k);
        } else {
            bsdf["material"] = "none";
            bsdf["specular_reflectance"] = value(reflectance);
            nearest(p, bsdf["type"], "its reflectance is the same at all angles");
        }
        return bsdf;
    }
    bsdf.update(metal(p, prefix, dictionary_));
    return bsdf;
}

Json Materials::conductor(const Parameters& p) {
    return twosided(metalBsdf(p, ""));
}

Json Materials::coatedConductor(const Parameters& p) {
    p.ignore({"maxdepth", "nsamples", "twosided", "thickness", "albedo", "g"});
    const Roughness rough = roughness(p, "interface.");
    const double eta = index(p, "interface.eta", 1.5, dictionary_);
    Json bsdf = metalBsdf(p, "conductor.");
    // The metal's constants are against vacuum, and what it meets is the coat.
    if (const std::string name = bsdf.value("material", ""); !name.empty() && name != "none") {
        const Metal& metal = *findMetal(name);
        bsdf.erase("material");
        bsdf["eta"] = colourJson(metal.eta);
        bsdf["k"] = colourJson(metal.k);
    }
    for (const char* constant : {"eta", "k"})
        if (bsdf.contains(constant)) bsdf[constant] = colourJson(parseSpectrum(JsonNode(bsdf[constant])) / eta);
    std::string difference = "light that the coat throws back inside is lost, and it absorbs nothing";
    Json coat = {{"type", rough.isSmooth ? "coating" : "roughcoating"}, {"int_ior", eta}, {"ext_ior", 1}};
    if (!rough.isSmooth) {
        coat["alpha"] = coatAlpha(p, rough, difference);
        coat["distribution"] = "ggx";
    }
    coat["bsdf"] = std::move(bsdf);
    nearest(p, coat["type"], difference);
    return twosided(std::move(coat));
}

Json Materials::dielectric(const Parameters& p) {
    const Roughness rough = roughness(p, "");
    const double eta = index(p, "eta", 1.5, dictionary_);
    // Without a difference of refraction nothing is rough either.
    const bool isSmooth = rough.isSmooth || eta == 1;
    Json bsdf = {{"type", isSmooth ? "dielectric" : "roughdielectric"}, {"int_ior", eta}, {"ext_ior", 1}};
    if (!isSmooth) setRoughness(bsdf, rough);
    return bsdf;
}

Json Materials::thinDielectric(const Parameters& p) {
    return {{"type", "thindielectric"}, {"int_ior", index(p, "eta", 1.5, dictionary_)}, {"ext_ior", 1}};
}

Json Materials::mix(const Parameters& p) {
    const Parameter& names = p.needed("materials", {"string"});
    if (names.texts.size() != 2)
        refuse(names.place, fmt::format("{} mixes two materials, found {}", p.owner(), names.texts.size()));
    const Texture amount = textures_.number(p, "amount", 0.5);
    Json result = {{"type", "blendbsdf"}, {"weight", value(amount)}};
    int number = 0;
    for (const std::string& name : names.texts) {
        const Converted& part = convert(indexOf({0, name, names.place}), parametrization_);
        textured_ |= part.textured;
        result[fmt::format("bsdf_{}", number++)] = {{"type", "ref"}, {"id", part.entry}};
    }
    return result;
}

}  // namespace ulam::pbrt
