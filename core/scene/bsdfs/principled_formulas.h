#pragma once
// The formulas of `principled`, for any scalar type.

#include "core/scene/bsdfs/principled.h"

namespace ulam {

/// (1 − x)⁵
template <class T>
T fifthPower(T x) {
    const T m = T(1) - x, m2 = m * m;
    return m > 0 ? m2 * m2 * m : T(0);
}

/// α_u and α_v keep their product, and may exceed 1.
inline MicrofacetDistribution Principled::microfacets() const {
    const double alpha = roughness * roughness, aspect = std::sqrt(1 - 0.9 * anisotropy);
    MicrofacetDistribution d(MicrofacetDistribution::Kind::Ggx, 1, 1);
    d.alphaU = std::max(1e-3, alpha / aspect);
    d.alphaV = std::max(1e-3, alpha * aspect);
    return d;
}

/// The base colour at luminance 1.
inline Spectrum Principled::tint() const {
    const double y = luminance(baseColor);
    return y > 0 ? baseColor / y : Spectrum(1.0);
}

/// Schlick's weight of white, from outside.
template <class T>
T Principled::schlickWeight(T cosine) const {
    if (!(ior < 1)) return fifthPower(cosine);
    const T thin = cosThinFromDense(cosine, 1 / ior);
    return thin > 0 ? fifthPower(thin) : T(1);
}

/// Fresnel factor of the microfacets, from outside. Between equal media nothing is reflected, not even by metal.
template <class T>
Color<T> Principled::reflectance(T cosine) const {
    const T fresnel = interfaceReflectance(cosine, ior, true);
    Color<T> f(fresnel * ((1 - metallic) * (1 - specTint)));
    if (metallic == 0 && specTint == 0) return f;
    if (ior == 1) return Color<T>(T(0));
    const T white = schlickWeight(cosine);
    const Spectrum normal = tint() * std::pow((ior - 1) / (ior + 1), 2);
    const auto add = [&](const Spectrum& r0, double weight) {
        for (int i = 0; i < 3; ++i) f[i] = f[i] + (T(r0[i]) + white * (1 - r0[i])) * weight;
    };
    add(baseColor, metallic);
    add(normal, (1 - metallic) * specTint);
    return f;
}

/// The diffuse part and the sheen; `cosine` is that of either direction with the half vector.
template <class T>
Color<T> Principled::diffuse(const Direction<T>& l, const Direction<T>& c, T cosine) const {
    const T fl = fifthPower(l.z), fc = fifthPower(c.z), retro = cosine * cosine * (2 * roughness);
    T f = (T(1) - fl * 0.5) * (T(1) - fc * 0.5) + retro * (fl + fc + fl * fc * (retro - T(1)));
    if (flatness > 0) {
        const T grazing = retro * 0.5 - T(1), flat = (T(1) + fl * grazing) * (T(1) + fc * grazing);
        f = f * (1 - flatness) + (flat * (T(1) / (l.z + c.z) - T(0.5)) + T(0.5)) * (1.25 * flatness);
    }
    const Color<T> sum = scaled(baseColor, f * (brdf() / kPi));
    if (!(sheen > 0)) return sum;
    return sum + scaled(Spectrum(1 - sheenTint) + tint() * sheenTint, fifthPower(cosine) * (sheen * (1 - metallic)));
}

/// GTR1 microfacets with GGX's masking of alpha 1/4, as Burley 2012 has them.
struct Principled::Clearcoat {
    double alpha2;

    explicit Clearcoat(const Principled& bsdf) : alpha2(std::pow(0.1 + (0.001 - 0.1) * bsdf.clearcoatGloss, 2)) {}

    template <class T>
    T density(const Direction<T>& m) const {
        return T((alpha2 - 1) / (kPi * std::log(alpha2))) / (T(alpha2) + (m.x * m.x + m.y * m.y) * (1 - alpha2));
    }
    template <class T>
    static T masking(const Direction<T>& w) {
        return w.z / MicrofacetDistribution(MicrofacetDistribution::Kind::Ggx, 0.25, 0.25).projectedArea(w);
    }
    /// Density of a reflection off a normal of density D cosθ.
    template <class T>
    T pdf(const InterfaceFacet<T>& facet) const {
        return density(facet.m) * facet.m.z * 0.5 / facet.length;
    }
    Vec3d sample(double u, double v) const {
        const double s2 = std::min(1.0, alpha2 * std::expm1(-u * std::log(alpha2)) / (1 - alpha2));
        const double s = std::sqrt(s2), phi = 2 * kPi * v;
        return {s * std::cos(phi), s * std::sin(phi), std::sqrt(1 - s2)};
    }
    Sample2 invert(const Vec3d& m) const {
        const double s2 = m.x * m.x + m.y * m.y;
        return {std::clamp(std::log1p(s2 * (1 - alpha2) / alpha2) / -std::log(alpha2), 0.0, 1.0), inverseAzimuth(m.x, m.y)};
    }
};

/// Probabilities of the parts for a walk that arrived along `from`: by what they roughly reflect.
template <class T>
struct Principled::Parts {
    T diffuse{0}, clearcoat{0}, facets{1};

    Parts(const Principled& bsdf, const Direction<T>& from) {
        if (!(from.z > 0)) return;
        const Color<T> f = bsdf.reflectance(from.z);
        const double mean = (bsdf.baseColor.x + bsdf.baseColor.y + bsdf.baseColor.z) / 3;
        const T r = (f.x + f.y + f.z) * (1.0 / 3) + (T(1) - interfaceReflectance(from.z, bsdf.ior, true)) * bsdf.refractedPart(true);
        // Sheen is where there is a diffuse part, if only a black one.
        const T d(bsdf.brdf() > 0 ? bsdf.brdf() * mean + 0.2 * (1 - bsdf.metallic) * bsdf.sheen : 0);
        const T c = (T(0.04) + bsdf.schlickWeight(from.z) * 0.96) * bsdf.clearcoat, total = r + d + c;
        if (!(total > 0)) return;
        diffuse = d / total;
        clearcoat = c / total;
        facets = r / total;
    }
};

template <class T>
Color<T> Principled::eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
    const InterfaceFacet<T> facet(ior, toLight, toCamera, lobe);
    const bool exterior = toLight.z > 0;
    if (!facet.scatters || (!transmits && !(exterior && toCamera.z > 0))) return Color<T>(T(0));
    const auto d = microfacets();
    const Direction<T> l = onUpperSide(toLight), c = onUpperSide(toCamera);
    if (!facet.reflects) {
        const Spectrum root(std::sqrt(baseColor.x), std::sqrt(baseColor.y), std::sqrt(baseColor.z));
        return scaled(root * bsdf(), (T(1) - facet.fresnel) * roughRefraction(d, facet, l, c, index(toCamera.z > 0)));
    }
    const T facets = roughReflection(d, l, c, facet.m);
    if (!exterior) return Color<T>(facet.fresnel * facets * bsdf());
    const T cosine = T(0.5) * facet.length;
    Color<T> f = reflectance(cosine) * facets;
    if (clearcoat > 0) {
        const Clearcoat coat(*this);
        const T fresnel = T(0.04) + schlickWeight(cosine) * 0.96;
        f = f + Color<T>(fresnel * coat.density(facet.m) * coat.masking(l) * coat.masking(c) * (0.25 * clearcoat));
    }
    if (brdf() > 0) f = f + diffuse(l, c, cosine);
    return f;
}

template <class T>
T Principled::pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
    const InterfaceFacet<T> facet(ior, from, to, lobe);
    const bool exterior = from.z > 0;
    if (!facet.scatters || (!transmits && !(exterior && to.z > 0))) return T(0);
    const auto d = microfacets();
    const Direction<T> w = onUpperSide(from);
    const Parts<T> parts(*this, from);
    const T refracted = (T(1) - facet.fresnel) * refractedPart(exterior);
    if (!facet.reflects) return parts.facets * refracted * roughRefractionPdf(d, facet, w, index(to.z > 0));
    const T facets = parts.facets * (T(1) - refracted) * roughReflectionPdf(d, w, facet.m);
    if (!exterior) return facets;
    return facets + parts.clearcoat * Clearcoat(*this).pdf(facet) + parts.diffuse * cosineHemispherePdf(to.z);
}

}  // namespace ulam
