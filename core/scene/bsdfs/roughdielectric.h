#pragma once
// roughdielectric: interface of two transparent media with microfacets (Mitsuba 3 `roughdielectric`; Walter et al. 2007,
// eq. 20 and 21). The shading normal points to the exterior. At the microfacet, reflection or transmission is chosen with
// the Fresnel reflectance; one smooth lobe holds both.
//
// m is normal to the microfacet and has z > 0; n_l and n_c are the indices on the sides of light and camera. Radiance from
// light to camera is scaled by n_c² on transmission, as in every f here.

#include "core/base/error.h"
#include "core/scene/bsdfs/facet.h"
#include "core/scene/bsdfs/parameters.h"

namespace ulam {

struct RoughDielectric {
    struct Parameters : InterfaceParameters {
        MicrofacetParameters microfacets;
        template <class V>
        void describe(V& v) {
            InterfaceParameters::describe(v);
            microfacets.describe(v);
        }
        double ior() const {
            if (intIor == extIor) fail(ExitCode::InvalidConfig, "roughdielectric: int_ior and ext_ior must differ");
            return intIor / extIor;
        }
    };
    explicit RoughDielectric(const Parameters& p)
        : ior(p.ior()),
          specularReflectance(p.specularReflectance),
          specularTransmittance(p.specularTransmittance),
          kind(MicrofacetDistribution::kindOf(p.microfacets.distribution)),
          alphaU(p.microfacets.alongU()),
          alphaV(p.microfacets.alongV()) {}

    static constexpr bool hasDelta = false, hasSmooth = true, transmits = true;
    bool anisotropic() const { return alphaU != alphaV; }

    template <class V>
    static void textured(V& v) {
        v("specular_reflectance", &RoughDielectric::specularReflectance);
        v("specular_transmittance", &RoughDielectric::specularTransmittance);
        v("alpha", &RoughDielectric::alphaU);
        v("alpha", &RoughDielectric::alphaV);
        v("alpha_u", &RoughDielectric::alphaU);
        v("alpha_v", &RoughDielectric::alphaV);
    }

    double albedo() const { return std::max(maxComponent(specularReflectance), maxComponent(specularTransmittance)); }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        const InterfaceFacet<T> facet(ior, toLight, toCamera, lobe);
        if (!facet.scatters) return Color<T>(T(0));
        const auto d = distribution();
        const Direction<T> l = onUpperSide(toLight), c = onUpperSide(toCamera);
        if (facet.reflects) return scaled(specularReflectance, facet.fresnel * roughReflection(d, l, c, facet.m));
        return scaled(specularTransmittance, (T(1) - facet.fresnel) * roughRefraction(d, facet, l, c, index(toCamera.z > 0)));
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        const InterfaceFacet<T> facet(ior, from, to, lobe);
        if (!facet.scatters) return T(0);
        const auto d = distribution();
        const Direction<T> w = onUpperSide(from);
        if (facet.reflects) return facet.fresnel * roughReflectionPdf(d, w, facet.m);
        return (T(1) - facet.fresnel) * roughRefractionPdf(d, facet, w, index(to.z > 0));
    }

    template <class T>
    T probability(const Direction<T>&, const Direction<T>&, Lobe lobe) const {
        return T(lobe == Lobe::Smooth ? 1 : 0);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const {
        if (lobe != Lobe::Smooth || from.z == 0) return std::nullopt;
        const Vec3d w = onUpperSide(Vec3d(from)), m = distribution().sampleVisible(w, u[0], u[1]);
        const double c = w.dot(m);
        if (!(c > 0)) return std::nullopt;
        const bool reflects = u[2] < interfaceReflectance(c, ior, from.z > 0);
        const Vec3d to = reflects ? mirroredAt(w, m) : refractedAt(w, m, from.z > 0 ? 1 / ior : ior);
        if (reflects != (to.z > 0) || to.z == 0) return std::nullopt;
        return ScatterSample{Vec3f(to * (from.z > 0 ? 1 : -1)).normalized(), Lobe::Smooth};
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const { return sampleLobe(from, Lobe::Smooth, u); }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
        const Vec3d w(from);
        const InterfaceFacet<double> facet(ior, w, Vec3d(to), lobe);
        // A direction is reflected or transmitted, according to its side.
        if (!facet.scatters || (facet.reflects ? facet.fresnel : 1 - facet.fresnel) <= 0) return false;
        const Sample2 s = distribution().invertVisible(onUpperSide(w), facet.m);
        u[0] = s.u;
        u[1] = s.v;
        u[2] = facet.reflects ? u[2] * facet.fresnel : facet.fresnel + u[2] * (1 - facet.fresnel);
        return true;
    }

    double ior;  // interior over exterior
    Spectrum specularReflectance, specularTransmittance;
    MicrofacetDistribution::Kind kind;
    double alphaU, alphaV;

private:
    MicrofacetDistribution distribution() const { return {kind, alphaU, alphaV}; }
    double index(bool exterior) const { return exterior ? 1 : ior; }
};

}  // namespace ulam
