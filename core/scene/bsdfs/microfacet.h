#pragma once
// Distributions of microfacet normals: Beckmann and GGX (Walter et al. 2007), anisotropic, with Smith's shadowing in its
// separable form G = G1 G1 as in Mitsuba 3. Mitsuba's G1 of Beckmann is a rational fit good to 0.35 %; here it is exact.
// Normals are sampled in proportion to what is seen of them (Heitz & d'Eon 2014), by maps with exact inverses.
//
// w is a unit direction with w.z >= 0 in the local frame, m the microfacet normal. Where formulas have G1(w) and cosθ,
// `projectedArea` has their quotient, which stays regular at grazing angles.

#include "core/scene/bsdfs/scattering.h"

#include <string>

namespace ulam {

/// What all rough BSDFs with textures for alpha have in common.
struct MicrofacetParameters {
    std::string distribution = "beckmann";
    double alpha = 0.1, alphaU = 0, alphaV = 0;
    bool sampleVisible = true;
    template <class V>
    void describe(V& v) {
        v("distribution", distribution, {.help = "of the microfacet normals", .choices = {"beckmann", "ggx"}});
        v("alpha", alpha, {.help = "roughness; of Beckmann the root mean square slope", .min = 1e-4, .max = 1});
        v("alpha_u", alphaU, {.help = "roughness along the tangent; 0: alpha", .min = 0, .max = 1});
        v("alpha_v", alphaV, {.help = "roughness along the bitangent; 0: alpha", .min = 0, .max = 1});
        v("sample_visible", sampleVisible, {.help = "without effect: visible normals are always sampled"});
    }
    double alongU() const { return alphaU > 0 ? alphaU : alpha; }
    double alongV() const { return alphaV > 0 ? alphaV : alpha; }
};

struct MicrofacetDistribution {
    enum class Kind : uint8_t { Beckmann, Ggx };

    MicrofacetDistribution(Kind k, double u, double v)
        : kind(k), alphaU(std::clamp(u, kMinAlpha, 1.0)), alphaV(std::clamp(v, kMinAlpha, 1.0)) {}

    static Kind kindOf(const std::string& name) { return name == "ggx" ? Kind::Ggx : Kind::Beckmann; }

    /// D(m): area of microfacets per area of surface and solid angle of normals.
    template <class T>
    T density(const Direction<T>& m) const {
        using std::exp;
        if (!(m.z > 0)) return T(0);
        const T x = m.x * (1 / alphaU), y = m.y * (1 / alphaV), z2 = m.z * m.z;
        const double scale = 1 / (kPi * alphaU * alphaV);
        if (kind == Kind::Beckmann) return exp((x * x + y * y) / -z2) * scale / (z2 * z2);
        const T r = x * x + y * y + z2;
        return T(scale) / (r * r);
    }

    /// cosθ / G1(w): the projected area of all microfacets that face w.
    template <class T>
    T projectedArea(const Direction<T>& w) const {
        using std::erf, std::exp, std::sqrt;
        const T x = w.x * alphaU, y = w.y * alphaV, s2 = x * x + y * y;
        if (kind == Kind::Ggx) return T(0.5) * (w.z + sqrt(w.z * w.z + s2));
        // Beyond that, what is missing to cosθ does not show in a double.
        if (w.z * w.z > 40 * s2) return w.z;
        const T s = sqrt(s2), a = w.z / s;
        return T(0.5) * (w.z * (T(1) + erf(a)) + s * exp(-(a * a)) * std::numbers::inv_sqrtpi);
    }

    /// Density of visible normals per solid angle.
    template <class T>
    T visible(const Direction<T>& w, const Direction<T>& m) const {
        const T cosine = w.dot(m);
        return cosine > 0 ? cosine * density(m) / projectedArea(w) : T(0);
    }

    /// A visible normal, and the numbers that make it.
    Vec3d sampleVisible(const Vec3d& w, double u, double v) const;
    Sample2 invertVisible(const Vec3d& w, const Vec3d& m) const;

    Kind kind;
    double alphaU, alphaV;

private:
    static constexpr double kMinAlpha = 1e-4;
};

/// The unit vector along h that has z > 0, and the length of h.
template <class T>
struct HalfVector {
    Direction<T> m;
    T length;

    explicit HalfVector(const Direction<T>& h) {
        using std::sqrt;
        length = sqrt(h.dot(h));
        m = h * (T(h.z > 0 ? 1 : -1) / length);
    }
};

/// D G / (4 cosθ_l cosθ_c), the part of a rough reflection that is not Fresnel's; both directions on one side.
template <class T>
T roughReflection(const MicrofacetDistribution& d, const Direction<T>& l, const Direction<T>& c, const Direction<T>& m) {
    return d.density(m) / (T(4) * d.projectedArea(l) * d.projectedArea(c));
}
/// Density of a reflection off a visible normal.
template <class T>
T roughReflectionPdf(const MicrofacetDistribution& d, const Direction<T>& from, const Direction<T>& m) {
    return d.density(m) / (T(4) * d.projectedArea(from));
}

inline Vec3d mirroredAt(const Vec3d& w, const Vec3d& m) { return m * (2 * w.dot(m)) - w; }

}  // namespace ulam
