#include "core/scene/pbrt/textures.h"

#include <fmt/format.h>

#include <array>

#include "core/config/suggest.h"

namespace ulam::pbrt {
namespace {

/// Rows map u, v and 1.
Matrix4 affine(const std::array<double, 2>& u, const std::array<double, 2>& v, const std::array<double, 2>& offset) {
    return {u[0], u[1], 0, 0, v[0], v[1], 0, 0, 0, 0, 1, 0, offset[0], offset[1], 0, 1};
}

Matrix4 mapping(const Parameters& p) {
    const std::string kind = p.text("mapping", "uv");
    if (kind != "uv") unknownName("mapping of a texture", kind, {"uv"}, p.find("mapping", {"string"})->place.text());
    const double us = p.number("uscale", 1), vs = p.number("vscale", 1), u = p.number("udelta", 0),
                 v = p.number("vdelta", 0);
    if (us == 0 || vs == 0) refuse(p.place(), fmt::format("uscale and vscale of {} must not be 0", p.owner()));
    return affine({us, 0}, {0, vs}, {u, v});
}

Texture constant(const Spectrum& colour, const Place& place) {
    Texture texture;
    texture.first = colour;
    texture.place = place;
    return texture;
}

}  // namespace

const Matrix4& toPbrt(Parametrization parametrization) {
    // A sphere's v grows from the south pole there. A disk has (u, v) = (azimuth / 2π, 1 − radius) there.
    static const Matrix4 same, sphere = affine({1, 0}, {0, -1}, {0, 1}), disk = affine({0, -1}, {1, 0}, {0, 1});
    return parametrization == Parametrization::Sphere ? sphere : parametrization == Parametrization::Disk ? disk : same;
}

void Textures::define(const std::string& name, const std::string& valueType, const std::string& type,
                      const Parameters& parameters) {
    if (valueType != "float" && valueType != "spectrum")
        unknownName("kind of texture", valueType, {"float", "spectrum"}, parameters.place().text());
    Named& textures = valueType == "float" ? numbers_ : colours_;
    if (textures.contains(name))
        refuse(parameters.place(), fmt::format("another {} texture is called {}", valueType, inQuotes(name)));
    Texture texture = read(type, valueType == "float", parameters);
    texture.name = name;
    texture.place = parameters.place();
    textures.emplace(name, std::move(texture));
}

Texture Textures::read(const std::string& type, bool isNumber, const Parameters& parameters) const {
    struct Reader {
        const char* type;
        Texture (Textures::*read)(const Parameters&, bool) const;
    };
    static constexpr std::array<Reader, 4> kReaders{{{"checkerboard", &Textures::checkerboard},
                                                     {"imagemap", &Textures::picture},
                                                     {"mix", &Textures::mixed},
                                                     {"scale", &Textures::scaled}}};
    std::vector<std::string> names{"constant"};
    if (type == "constant") {
        const Texture texture = value(parameters, "value", isNumber, 1);
        parameters.finish();
        return texture;
    }
    for (const Reader& reader : kReaders) {
        if (type == reader.type) {
            const Texture texture = (this->*reader.read)(parameters, isNumber);
            parameters.finish();
            return texture;
        }
        names.emplace_back(reader.type);
    }
    dictionary_.unknown("texture", type, names, parameters.place(), "magenta takes its place");
    return constant({1, 0, 1}, parameters.place());
}

Texture Textures::unsupported(const std::string& what, const Parameters& parameters) const {
    dictionary_.unsupported(what, parameters.place(), {}, "magenta takes its place");
    return constant({1, 0, 1}, parameters.place());
}

Texture Textures::picture(const Parameters& p, bool) const {
    Texture texture;
    texture.kind = Texture::Kind::Picture;
    const Parameter& filename = p.needed("filename", {"string"});
    texture.plugin = {{"type", "bitmap"}, {"filename", p.text("filename", "")}};
    const std::string filter = p.text("filter", "bilinear"), wrap = p.text("wrap", "repeat"),
                      encoding = p.text("encoding", "sRGB");
    p.number("maxanisotropy", 8);
    // The others differ in how they smooth what is smaller than a pixel; here the pixel's samples do that.
    if (filter == "point")
        texture.plugin["filter_type"] = "nearest";
    else if (filter != "bilinear" && filter != "trilinear" && filter != "EWA" && filter != "ewa")
        unknownName("filter", filter, {"bilinear", "EWA", "point", "trilinear"}, filename.place.text());
    if (wrap == "clamp")
        texture.plugin["wrap_mode"] = "clamp";
    else if (wrap != "repeat")
        return unsupported(
            fmt::format("wrap {} of {} (other than \"repeat\" and \"clamp\")", inQuotes(wrap), p.owner()), p);
    if (encoding == "linear")
        texture.plugin["raw"] = true;
    else if (encoding != "sRGB")
        return unsupported(
            fmt::format("encoding {} of {} (other than \"sRGB\" and \"linear\")", inQuotes(encoding), p.owner()), p);
    texture.first = Spectrum(p.number("scale", 1));
    if (p.flag("invert", false)) texture.plugin["invert"] = true;
    // There the picture's upper edge is at v = 1.
    texture.toUv = mapping(p) * affine({1, 0}, {0, -1}, {0, 1});
    return texture;
}

Texture Textures::checkerboard(const Parameters& p, bool isNumber) const {
    Texture texture;
    texture.kind = Texture::Kind::Checkerboard;
    if (p.integer("dimension", 2) != 2) return unsupported(fmt::format("{} in 3 dimensions", p.owner()), p);
    const Texture first = value(p, "tex1", isNumber, 1), second = value(p, "tex2", isNumber, 0);
    if (!first.isConstant() || !second.isConstant())
        return unsupported(fmt::format("{} of other textures", p.owner()), p);
    texture.first = first.first;
    texture.second = second.first;
    // There a square is a unit, here half of one.
    texture.toUv = mapping(p) * affine({0.5, 0}, {0, 0.5}, {0, 0});
    return texture;
}

Texture Textures::product(const Texture& a, const Texture& b, const Parameters& p) const {
    if (!a.isConstant() && !b.isConstant()) return unsupported(fmt::format("{} by another texture", p.owner()), p);
    Texture result = a.isConstant() ? b : a;
    const Spectrum factor = (a.isConstant() ? a : b).first;
    if (result.plugin.contains("invert") && factor != Spectrum(1.0))
        return unsupported(fmt::format("{} of an inverted picture", p.owner()), p);
    result.first *= factor;
    result.second *= factor;
    return result;
}

Texture Textures::scaled(const Parameters& p, bool isNumber) const {
    return product(value(p, "tex", isNumber, 1), number(p, "scale", 1), p);
}

Texture Textures::mixed(const Parameters& p, bool isNumber) const {
    const Texture a = value(p, "tex1", isNumber, 0), b = value(p, "tex2", isNumber, 1),
                  amount = value(p, "amount", true, 0.5);
    const Spectrum t = amount.first;
    if (amount.isConstant() && t == Spectrum(0.0)) return a;
    if (amount.isConstant() && t == Spectrum(1.0)) return b;
    if (!a.isConstant() || !b.isConstant() || amount.kind == Texture::Kind::Picture)
        return unsupported(fmt::format("{} of textures that are not constant", p.owner()), p);
    const auto at = [&](const Spectrum& s) { return a.first * (Spectrum(1.0) - s) + b.first * s; };
    Texture result = amount;
    result.first = at(amount.first);
    result.second = at(amount.second);
    return result;
}

Texture Textures::named(const Named& textures, const Parameter& parameter) const {
    std::vector<std::string> names;
    for (const auto& [name, texture] : textures) names.push_back(name);
    if (parameter.texts.size() != 1)
        refuse(parameter.place, fmt::format("{} names one texture", inQuotes(parameter.name)));
    const auto found = textures.find(parameter.texts[0]);
    if (found == textures.end()) unknownName("texture", parameter.texts[0], names, parameter.place.text());
    return found->second;
}

Texture Textures::value(const Parameters& owner, std::string_view name, bool isNumber, double otherwise) const {
    return isNumber ? number(owner, name, otherwise) : colour(owner, name, Spectrum(otherwise));
}

Texture Textures::colour(const Parameters& owner, std::string_view name, const Spectrum& otherwise) const {
    const Parameter* parameter = owner.find(name, {"rgb", "spectrum", "texture"});
    if (!parameter) return constant(otherwise, owner.place());
    if (parameter->type == "texture") return named(colours_, *parameter);
    return constant(reflectance(owner, *parameter, dictionary_), parameter->place);
}

Texture Textures::number(const Parameters& owner, std::string_view name, double otherwise) const {
    const Parameter* parameter = owner.find(name, {"float", "texture"});
    if (!parameter) return constant(Spectrum(otherwise), owner.place());
    if (parameter->type == "texture") return named(numbers_, *parameter);
    return constant(Spectrum(owner.number(name, otherwise)), parameter->place);
}

Json Textures::use(const Texture& texture, Parametrization parametrization) {
    if (texture.isConstant()) return colourJson(texture.first);
    Json plugin = texture.plugin;
    if (texture.kind == Texture::Kind::Picture) {
        if (texture.first != Spectrum(1.0)) plugin["scale"] = colourJson(texture.first);
    } else {
        plugin = {
            {"type", "checkerboard"}, {"color0", colourJson(texture.first)}, {"color1", colourJson(texture.second)}};
    }
    const Matrix4 toUv = toPbrt(parametrization) * texture.toUv;
    if (toUv != Matrix4()) plugin["to_uv"] = matrixJson(toUv);
    const auto [entry, isNew] = entries_.try_emplace(plugin.dump());
    if (isNew) {
        entry->second = dictionary_.name(texture.name);
        dictionary_.add(entry->second, std::move(plugin), texture.place);
    }
    return {{"type", "ref"}, {"id", entry->second}};
}

}  // namespace ulam::pbrt
