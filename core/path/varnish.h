#pragma once
// A dielectric coat over what is nested, smooth or rough, at one point of a surface: `coating` and `roughcoating` of
// Mitsuba 0.6, after Weidlich & Wilkie 2007. Light is reflected off the coat, or refracted at the surface's own normal,
// scattered by what is nested and refracted out again; what is reflected inside is lost. With the refracted directions
// l' and c',
//   f = f_coat(l, c) + T(l) T(c) exp(−σ (1/cosθ_l' + 1/cosθ_c')) f_nested(l', c') / η²,
// on the side of the shading normal. T is 1 − F, or the transmittance of a rough coat (roughplastic.h).

#include "core/path/layers.h"
#include "core/scene/bsdfs/coat.h"

namespace ulam {

class VarnishAt {
public:
    static constexpr bool hasDelta = true, hasSmooth = true, transmits = false;

    VarnishAt(const Scene& scene, const Vertex& v, const Varnish& varnish);

    bool anisotropic() const { return true; }
    double albedo() const { return std::max(maxComponent(varnish_.specularReflectance), nestedAlbedo_); }
    double smoothShare(const Vec3f& from) const;

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        if (!(toLight.z > 0 && toCamera.z > 0)) return Color<T>(T(0));
        const Direction<T> l = inside(toLight), c = inside(toCamera);
        // δ_σ inside is η² δ_σ outside.
        const T crossed = crossing(toLight.z) * crossing(toCamera.z) * (lobe == Lobe::Smooth ? 1 / (ior() * ior()) : 1);
        return nested([&](const auto& bsdf) { return bsdf.eval(l, c, lobe); }) * attenuation(T(1) / l.z + T(1) / c.z) *
                   crossed +
               scaled(varnish_.specularReflectance, reflection(toLight, toCamera, lobe));
    }
    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        if (!(from.z > 0 && to.z > 0)) return T(0);
        const T share = coatShare(from.z);
        return share * reflectionPdf(from, to, lobe) + (T(1) - share) * nestedPdf(from, to, lobe);
    }
    template <class T>
    T probability(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        if (!(from.z > 0 && to.z > 0)) return T(0);
        const T share = coatShare(from.z), coat(lobe == coatLobe() ? 1 : 0);
        return share * coat + (T(1) - share) * nested([&](const auto& bsdf) {
                                  return bsdf.probability(inside(from), inside(to), lobe);
                              });
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, Block u) const;
    std::optional<ScatterSample> sample(const Vec3f& from, Block u) const;
    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const;

    const Varnish& varnish() const { return varnish_; }
    double nestedAlbedo() const { return nestedAlbedo_; }
    template <class Function>
    decltype(auto) nested(Function&& function) const {
        return withCoating(scene_, v_, varnish_.nested[0], function);
    }

private:
    double ior() const { return varnish_.ior; }
    Lobe coatLobe() const { return varnish_.rough ? Lobe::Smooth : Lobe::DeltaReflection; }

    /// A direction above the surface as it is refracted into the coat, still pointing away from what is nested.
    template <class T>
    Direction<T> inside(const Direction<T>& w) const {
        using std::sqrt;
        const auto scale = T(1 / ior());
        return {w.x * scale, w.y * scale, sqrt(T(1) - (T(1) - w.z * w.z) * (scale * scale))};
    }
    /// The part of the light from outside that reaches what is nested.
    template <class T>
    T crossing(T cosTheta) const {
        return varnish_.rough ? varnish_.rough->transmittance(cosTheta) : T(1) - fresnelFromThinSide(cosTheta, ior());
    }
    template <class T>
    Color<T> attenuation(T lengths) const {
        using std::exp;
        const Spectrum& depth = varnish_.opticalDepth;
        return {exp(lengths * -depth.x), exp(lengths * -depth.y), exp(lengths * -depth.z)};
    }
    /// f of a coat that reflects without tint.
    template <class T>
    T reflection(const Direction<T>& l, const Direction<T>& c, Lobe lobe) const {
        if (lobe != coatLobe()) return T(0);
        if (!varnish_.rough) return fresnelFromThinSide(T(0.5) * (l.z + c.z), ior());
        const HalfVector<T> h(l + c);
        return fresnelFromThinSide(T(0.5) * h.length, ior()) * roughReflection(varnish_.rough->distribution, l, c, h.m);
    }
    template <class T>
    T reflectionPdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        if (lobe != coatLobe()) return T(0);
        return varnish_.rough ? roughReflectionPdf(varnish_.rough->distribution, from, HalfVector<T>(from + to).m)
                              : to.z;
    }
    /// cosθ dω = η² cosθ' dω'.
    template <class T>
    T nestedPdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        const Direction<T> w = inside(to);
        const T pdf = nested([&](const auto& bsdf) { return bsdf.pdf(inside(from), w, lobe); });
        return pdf * (to.z / w.z) * (lobe == Lobe::Smooth ? 1 / (ior() * ior()) : 1);
    }
    /// Probability of sampling the coat's reflection.
    template <class T>
    T coatShare(T cosTheta) const {
        return coatProbability(T(1) - crossing(cosTheta), varnish_.specularReflectance, Spectrum(nestedAlbedo_));
    }

    /// Where the coat's part of the number that chooses begins. Delta lobes have the lower end, here and in what is
    /// nested.
    double coatBegin(const Vec3f& from, double share) const;
    std::optional<ScatterSample> reflect(const Vec3f& from, const Block& u) const;
    std::optional<ScatterSample> outside(std::optional<ScatterSample> sample) const;

    const Scene& scene_;
    const Vertex& v_;
    const Varnish& varnish_;
    double nestedAlbedo_;
};

}  // namespace ulam
