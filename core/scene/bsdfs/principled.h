#pragma once
// principled: Disney's BSDF (Burley 2012, "Physically based shading at Disney", and 2015, "Extending the Disney BRDF to a BSDF
// with integrated subsurface scattering") as Mitsuba 3 defines it. On the side of the shading normal, the exterior, the sum of
//   - diffuse reflection with retro-reflection, blended with a flat fake of subsurface scattering, and sheen;
//   - microfacet reflection (GGX), its Fresnel factor a blend of dielectric, tinted and metallic;
//   - clearcoat: GTR1 microfacets, of which nothing but a quarter of D F G is left (no 4 cosθ_l cosθ_c);
// and from either side rough refraction, tinted by the root of the base colour, with its reflection inside. Reciprocal (but for
// η²); nothing bounds the sum of the lobes, which may give back more than they receive at grazing angles.
//
// One smooth lobe, sampled as a mixture: u[2] chooses between the diffuse part, the clearcoat and microfacets, and whether
// those reflect. From inside there are microfacets only.

#include "core/scene/bsdfs/facet.h"
#include "core/scene/bsdfs/mixture.h"

namespace ulam {

struct Principled {
    struct Parameters {
        Spectrum baseColor{0.5, 0.5, 0.5};
        double roughness = 0.5, anisotropic = 0, metallic = 0, specTrans = 0, eta = 1.5, specular = 0.5, specTint = 0;
        double sheen = 0, sheenTint = 0, flatness = 0, clearcoat = 0, clearcoatGloss = 0;
        double diffuseRate = 1, specularRate = 1, clearcoatRate = 1;
        template <class V>
        void describe(V& v) {
            v("base_color", baseColor, {.help = "of the diffuse part and of metal; its root tints glass", .min = 0, .max = 1});
            v("roughness", roughness, {.help = "root of the microfacets' alpha", .min = 0, .max = 1});
            v("anisotropic", anisotropic, {.help = "stretches the highlight along the tangent; 0: isotropic", .min = 0, .max = 1});
            v("metallic", metallic, {.help = "0: dielectric, 1: metal", .min = 0, .max = 1});
            v("spec_trans", specTrans, {.help = "0: diffuse, 1: glass", .min = 0, .max = 1});
            v("eta", eta, {.help = "index of refraction, interior over exterior", .min = 0.1, .max = 10});
            v("specular", specular, {.help = "another way to say eta: 2 / (1 - sqrt(0.08 specular)) - 1", .min = 0, .max = 1});
            v("spec_tint", specTint, {.help = "tint of the dielectric reflection by the base colour", .min = 0, .max = 1});
            v("sheen", sheen, {.help = "strength of the sheen", .min = 0, .max = 1});
            v("sheen_tint", sheenTint, {.help = "tint of the sheen by the base colour", .min = 0, .max = 1});
            v("flatness", flatness, {.help = "0: diffuse, 1: as if light scattered below the surface", .min = 0, .max = 1});
            v("clearcoat", clearcoat, {.help = "strength of the clearcoat", .min = 0, .max = 1});
            v("clearcoat_gloss", clearcoatGloss, {.help = "0: alpha of the clearcoat is 0.1, 1: it is 0.001", .min = 0, .max = 1});
            v("diffuse_reflectance_sampling_rate", diffuseRate, {.help = "without effect"});
            v("main_specular_sampling_rate", specularRate, {.help = "without effect"});
            v("clearcoat_sampling_rate", clearcoatRate, {.help = "without effect"});
        }
        /// Interior over exterior. Refraction needs two media, so there an index of 1 becomes 1.001, a specular of 0 0.001.
        double ior() const {
            const bool refracts = specTrans > 0;
            const double s = refracts ? std::max(specular, 1e-3) : specular;
            const double n = specular == 0.5 ? eta : 2 / (1 - std::sqrt(0.08 * s)) - 1;
            return refracts && n == 1 ? 1.001 : n;
        }
    };
    explicit Principled(const Parameters& p)
        : baseColor(p.baseColor), roughness(p.roughness), anisotropy(p.anisotropic), metallic(p.metallic), ior(p.ior()),
          specTint(p.specTint), sheen(p.sheen), sheenTint(p.sheenTint), flatness(p.flatness), clearcoat(p.clearcoat),
          clearcoatGloss(p.clearcoatGloss), refraction(p.specTrans), transmits(p.specTrans > 0) {}

    static constexpr bool hasDelta = false, hasSmooth = true;
    bool anisotropic() const { return anisotropy > 0; }

    template <class V>
    static void textured(V& v) {
        v("base_color", &Principled::baseColor);
        v("roughness", &Principled::roughness);
        v("anisotropic", &Principled::anisotropy);
        v("metallic", &Principled::metallic);
        v("spec_tint", &Principled::specTint);
        v("sheen", &Principled::sheen);
        v("sheen_tint", &Principled::sheenTint);
        v("flatness", &Principled::flatness);
        v("clearcoat", &Principled::clearcoat);
        v("clearcoat_gloss", &Principled::clearcoatGloss);
    }

    /// The sum of what bounds each lobe.
    double albedo() const;

    // Defined in principled_formulas.h, compiled in principled.cpp for paths.
    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const;
    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const;
    template <class T>
    T probability(const Direction<T>&, const Direction<T>&, Lobe lobe) const {
        return T(lobe == Lobe::Smooth ? 1 : 0);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const;
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const { return sampleLobe(from, Lobe::Smooth, u); }
    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const;

    Spectrum baseColor;
    double roughness, anisotropy, metallic;
    double ior;  ///< interior over exterior
    double specTint, sheen, sheenTint, flatness, clearcoat, clearcoatGloss;
    double refraction;  ///< spec_trans: no texture, so that `transmits` is fixed
    bool transmits;

private:
    template <class T>
    struct Parts;
    struct Clearcoat;

    double brdf() const { return (1 - metallic) * (1 - refraction); }  // weight of the diffuse part
    double bsdf() const { return (1 - metallic) * refraction; }        // weight of refraction
    double index(bool exterior) const { return exterior ? 1 : ior; }

    MicrofacetDistribution microfacets() const;
    Spectrum tint() const;
    template <class T>
    T schlickWeight(T cosine) const;
    template <class T>
    Color<T> reflectance(T cosine) const;
    template <class T>
    Color<T> diffuse(const Direction<T>& l, const Direction<T>& c, T cosine) const;
    /// Of what Fresnel's reflectance leaves, the part that is sampled as refraction.
    double refractedPart(bool exterior) const { return exterior ? bsdf() : 1; }
};

}  // namespace ulam
