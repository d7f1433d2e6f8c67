#pragma once
// The BSDF at one point of a surface: the right side of its material, its textures looked up, its layers in place.

#include "core/path/varnish.h"

#include <utility>

namespace ulam {

/// Directions in the local frame of the shading normal at v, as the BSDF on their side sees them. Made only once the BSDF
/// is known: what a formula does not use of it is never computed.
class LocalFrame {
public:
    LocalFrame(const Frame& frame, bool mirrored) : frame_(frame), mirrored_(mirrored) {}
    [[gnu::always_inline]] Vec3f toLocal(const Vec3f& w) const { return mirror(frame_.toLocal(w)); }
    [[gnu::always_inline]] Vec3f toWorld(const Vec3f& w) const { return frame_.toWorld(mirror(w)); }

private:
    [[gnu::always_inline]] Vec3f mirror(const Vec3f& w) const { return {w.x, w.y, mirrored_ ? -w.z : w.z}; }

    Frame frame_;
    bool mirrored_;
};

/// Around the shading normal; x along ∂p/∂u where the BSDF asks for it.
template <class B>
[[gnu::always_inline]] inline LocalFrame localFrame(const Scene& scene, const Vertex& v, const B& bsdf, bool mirrored) {
    if constexpr (requires { bsdf.anisotropic(); })
        if (bsdf.anisotropic()) return {Frame(v.shadingNormal, scene.shapes[v.shape].tangent(v)), mirrored};
    return {Frame(v.shadingNormal), mirrored};
}

/// Writes a texture's value into the member with this index of the list `textured`.
template <class B>
void bind(B& bsdf, const TexturedBsdf::Binding& binding, const Texture& texture, const Vec2f& uv) {
    int index = 0;
    auto visit = [&]<class M>(const char*, M B::*member) {
        if (index++ != binding.member) return;
        if constexpr (std::is_same_v<M, double>) bsdf.*member = textureValue(texture, uv);
        else bsdf.*member = textureColor(texture, uv);
    };
    B::textured(visit);
}

template <class Function>
decltype(auto) withCoating(const Scene& scene, const Vertex& v, const Coating& coating, Function&& function) {
    const auto* textured = std::get_if<TexturedBsdf>(&coating.layer);
    if (!textured) [[unlikely]] {
        if (const auto* mixture = std::get_if<Mixture>(&coating.layer)) return function(MixtureAt(scene, v, *mixture));
        if (const auto* relief = std::get_if<Relief>(&coating.layer)) return function(ReliefAt(scene, v, *relief));
        return function(VarnishAt(scene, v, std::get<Varnish>(coating.layer)));
    }
    return dispatch(textured->bsdf, [&]<class B>(const B& plain) -> decltype(auto) {
        if (textured->bindings.empty()) return function(plain);
        B bound = plain;
        const Vec2f uv = scene.shapes[v.shape].texcoord(v);
        for (const TexturedBsdf::Binding& b : textured->bindings) bind(bound, b, scene.textures[b.texture], uv);
        return function(std::as_const(bound));
    });
}

/// Calls `function(bsdf, frame)` with the BSDF on the side of a direction with this cosine to the shading normal.
template <class Function>
decltype(auto) withBsdf(const Scene& scene, const Vertex& v, float cosTheta, Function&& function) {
    const Material& material = scene.materialAt(v);
    const bool mirrored = material.back && !(cosTheta > 0);
    return withCoating(scene, v, mirrored ? *material.back : material.front,
                       [&](const auto& bsdf) -> decltype(auto) { return function(bsdf, localFrame(scene, v, bsdf, mirrored)); });
}

}  // namespace ulam
