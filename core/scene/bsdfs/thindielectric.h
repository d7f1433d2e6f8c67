#pragma once
// thindielectric: a pane so thin that what it transmits goes straight on (Mitsuba 3 `thindielectric`). Of the light, the
// first interface reflects R, and all orders of reflection between the two add up to R' = 2R / (1 + R); the outside is the
// same on both sides.

#include "core/scene/bsdfs/fresnel.h"
#include "core/scene/bsdfs/parameters.h"
#include "core/scene/bsdfs/scattering.h"

namespace ulam {

struct ThinDielectric {
    using Parameters = InterfaceParameters;
    explicit ThinDielectric(const Parameters& p)
        : ior(p.intIor / p.extIor),
          specularReflectance(p.specularReflectance),
          specularTransmittance(p.specularTransmittance) {}

    static constexpr bool hasDelta = true, hasSmooth = false, transmits = true;

    template <class V>
    static void textured(V& v) {
        v("specular_reflectance", &ThinDielectric::specularReflectance);
        v("specular_transmittance", &ThinDielectric::specularTransmittance);
    }

    double albedo() const { return std::max(maxComponent(specularReflectance), maxComponent(specularTransmittance)); }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        const T chosen = part(toLight, toCamera, lobe);
        return scaled(lobe == Lobe::Null ? specularTransmittance : specularReflectance, chosen);
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        using std::abs;
        return part(from, to, lobe) * abs(to.z);
    }

    template <class T>
    T probability(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        return part(from, to, lobe);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block&) const {
        if (from.z == 0) return std::nullopt;
        if (lobe == Lobe::DeltaReflection) return ScatterSample{reflected(from), lobe};
        if (lobe == Lobe::Null) return ScatterSample{-from, lobe};
        return std::nullopt;
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const {
        return sampleLobe(from, u[2] < reflectance(double(std::abs(from.z))) ? Lobe::DeltaReflection : Lobe::Null, u);
    }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
        const double chosen = part(Vec3d(from), Vec3d(to), lobe);
        if (chosen <= 0) return false;
        u[2] = lobe == Lobe::DeltaReflection ? u[2] * chosen : 1 - chosen + u[2] * chosen;
        return true;
    }

    double ior;  // pane over surroundings
    Spectrum specularReflectance, specularTransmittance;

private:
    /// R' or 1 − R', with the mean of both cosines, so that both ends of a path agree on it.
    template <class T>
    T part(const Direction<T>& a, const Direction<T>& b, Lobe lobe) const {
        using std::abs;
        const bool reflects = lobe == Lobe::DeltaReflection && a.z * b.z > 0;
        if (!reflects && !goesThrough(a, b, lobe)) return T(0);
        const T r = reflectance(T(0.5) * (abs(a.z) + abs(b.z)));
        return reflects ? r : T(1) - r;
    }

    template <class T>
    T reflectance(T cosTheta) const {
        const T r = fresnelDielectric(cosTheta, std::max(ior, 1 / ior), ior > 1);
        return T(2) * r / (T(1) + r);
    }
};

}  // namespace ulam
