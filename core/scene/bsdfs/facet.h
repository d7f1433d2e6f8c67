#pragma once
// Reflection and refraction at the microfacets of an interface of two transparent media (Walter et al. 2007). The shading
// normal points to the exterior; ior is the index of the interior over that of the exterior.

#include "core/scene/bsdfs/fresnel.h"
#include "core/scene/bsdfs/microfacet.h"

namespace ulam {

/// A distribution is symmetric about the origin: below the surface it is seen as from above.
template <class T>
Direction<T> onUpperSide(const Direction<T>& w) {
    return w.z > 0 ? w : -w;
}

/// Fresnel's reflectance of the interface seen from one side.
template <class T>
T interfaceReflectance(T cosTheta, double ior, bool exterior) {
    return fresnelDielectric(cosTheta, std::max(ior, 1 / ior), exterior == (ior > 1));
}

/// The microfacet that reflects or refracts between two directions.
template <class T>
struct InterfaceFacet {
    bool reflects, scatters;
    Direction<T> m;  ///< towards the exterior
    T length;        ///< |n_a a + n_b b|, in units of the exterior's index
    T cosines;       ///< |a·m| |b·m|
    T fresnel;

    InterfaceFacet(double ior, const Direction<T>& a, const Direction<T>& b, Lobe lobe)
        : reflects(a.z * b.z > 0), scatters(lobe == Lobe::Smooth && !(a.z * b.z == 0)) {
        using std::abs;
        if (!scatters) return;
        const double nA = reflects || a.z > 0 ? 1 : ior, nB = reflects || b.z > 0 ? 1 : ior;
        const HalfVector<T> h(a * T(nA) + b * T(nB));
        m = h.m;
        length = h.length;
        // Both on their own sides of the microfacet, as of the surface.
        const T cosA = a.dot(m), cosB = b.dot(m);
        scatters = cosA * a.z > 0 && cosB * b.z > 0;
        if (!scatters) return;
        cosines = abs(cosA * cosB);
        if (reflects)
            fresnel = interfaceReflectance(T(0.5) * length, ior, a.z > 0);
        else
            fresnel = fresnelFromThinSide(abs((a.z > 0) == (ior > 1) ? cosA : cosB), std::max(ior, 1 / ior));
    }
};

/// The part of a rough refraction that is not Fresnel's, towards the medium of index n (of the exterior: 1). Directions are
/// seen on the upper side, each from its own.
template <class T>
T roughRefraction(const MicrofacetDistribution& d, const InterfaceFacet<T>& facet, const Direction<T>& l, const Direction<T>& c,
                  double n) {
    const T geometry = facet.cosines * d.density(facet.m) / (d.projectedArea(l) * d.projectedArea(c));
    return geometry * (n * n) / (facet.length * facet.length);
}
/// Density of a refraction at a visible normal, by dω_m / dω_to.
template <class T>
T roughRefractionPdf(const MicrofacetDistribution& d, const InterfaceFacet<T>& facet, const Direction<T>& from, double n) {
    return facet.cosines * d.density(facet.m) / d.projectedArea(from) * (n * n) / (facet.length * facet.length);
}

/// w refracted at m, with w·m > 0 and short of total reflection; `relative` is the index on w's side over that beyond.
inline Vec3d refractedAt(const Vec3d& w, const Vec3d& m, double relative) {
    const double c = w.dot(m), c2 = 1 - (1 - c * c) * relative * relative;
    return m * (relative * c - std::sqrt(std::max(0.0, c2))) - w * relative;
}

}  // namespace ulam
