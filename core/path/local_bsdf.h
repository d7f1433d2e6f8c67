#pragma once
// The BSDF at one point of a surface: the right side of its material, its textures looked up, its cuts applied.

#include "core/path/path.h"

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
void bind(B& bsdf, const Coating::Binding& binding, const Texture& texture, const Vec2f& uv) {
    int index = 0;
    auto visit = [&]<class M>(const char*, M B::*member) {
        if (index++ != binding.member) return;
        if constexpr (std::is_same_v<M, double>) bsdf.*member = textureValue(texture, uv);
        else bsdf.*member = textureColor(texture, uv);
    };
    B::textured(visit);
}

inline double opacityAt(const Scene& scene, const Vertex& v) {
    const Material& m = scene.materialAt(v);
    if (m.opacityTexture == kNone) return m.opacity;
    return std::clamp(textureValue(scene.textures[m.opacityTexture], scene.shapes[v.shape].texcoord(v)), 0.0, 1.0);
}

/// Calls `function(bsdf)` with a coating of v's material as it is at v.
template <class Function>
decltype(auto) withCoating(const Scene& scene, const Vertex& v, const Coating& coating, Function&& function) {
    return dispatch(coating.bsdf, [&]<class B>(const B& plain) -> decltype(auto) {
        const auto cut = [&](const B& bsdf) -> decltype(auto) {
            if (scene.materialAt(v).masked) return function(Masked<B>{bsdf, opacityAt(scene, v)});
            return function(bsdf);
        };
        if (coating.bindings.empty()) return cut(plain);
        B bound = plain;
        const Vec2f uv = scene.shapes[v.shape].texcoord(v);
        for (const Coating::Binding& b : coating.bindings) bind(bound, b, scene.textures[b.texture], uv);
        return cut(bound);
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
