#pragma once
// roughconductor: metal with microfacets, on the side of the shading normal (Mitsuba 3 `roughconductor`):
// f_s = F(l·m) D(m) G1(l) G1(c) / (4 cosθ_l cosθ_c) with m half way between l and c (Walter et al. 2007, eq. 20).

#include "core/scene/bsdfs/fresnel.h"
#include "core/scene/bsdfs/microfacet.h"
#include "core/scene/bsdfs/parameters.h"

namespace ulam {

struct RoughConductor {
    struct Parameters : MetalParameters {
        MicrofacetParameters microfacets;
        template <class V>
        void describe(V& v) {
            MetalParameters::describe(v);
            microfacets.describe(v);
        }
    };
    explicit RoughConductor(const Parameters& p)
        : eta(p.eta),
          k(p.k),
          specularReflectance(p.specularReflectance),
          kind(MicrofacetDistribution::kindOf(p.microfacets.distribution)),
          alphaU(p.microfacets.alongU()),
          alphaV(p.microfacets.alongV()) {}

    static constexpr bool hasDelta = false, hasSmooth = true, transmits = false;
    bool anisotropic() const { return alphaU != alphaV; }

    template <class V>
    static void textured(V& v) {
        v("eta", &RoughConductor::eta);
        v("k", &RoughConductor::k);
        v("specular_reflectance", &RoughConductor::specularReflectance);
        v("alpha", &RoughConductor::alphaU);
        v("alpha", &RoughConductor::alphaV);
        v("alpha_u", &RoughConductor::alphaU);
        v("alpha_v", &RoughConductor::alphaV);
    }

    double albedo() const { return maxComponent(specularReflectance); }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        if (lobe != Lobe::Smooth || !(toLight.z > 0 && toCamera.z > 0)) return Color<T>(T(0));
        const HalfVector<T> h(toLight + toCamera);
        return scaled(specularReflectance, roughReflection(distribution(), toLight, toCamera, h.m)) *
               fresnelConductor(T(0.5) * h.length, eta, k);
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        if (lobe != Lobe::Smooth || !(from.z > 0 && to.z > 0)) return T(0);
        return roughReflectionPdf(distribution(), from, HalfVector<T>(from + to).m);
    }

    template <class T>
    T probability(const Direction<T>&, const Direction<T>&, Lobe lobe) const {
        return T(lobe == Lobe::Smooth ? 1 : 0);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const {
        if (lobe != Lobe::Smooth || !(from.z > 0)) return std::nullopt;
        const Vec3d w(from);
        const Vec3f to(mirroredAt(w, distribution().sampleVisible(w, u[0], u[1])));
        if (!(to.z > 0)) return std::nullopt;
        return ScatterSample{to, Lobe::Smooth};
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const { return sampleLobe(from, Lobe::Smooth, u); }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
        if (lobe != Lobe::Smooth || !(from.z > 0 && to.z > 0)) return false;
        const Vec3d w(from);
        const Sample2 s = distribution().invertVisible(w, HalfVector<double>(w + Vec3d(to)).m);
        u[0] = s.u;
        u[1] = s.v;
        return true;
    }

    Spectrum eta, k, specularReflectance;
    MicrofacetDistribution::Kind kind;
    double alphaU, alphaV;

private:
    MicrofacetDistribution distribution() const { return {kind, alphaU, alphaV}; }
};

}  // namespace ulam
