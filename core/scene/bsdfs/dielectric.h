#pragma once
// dielectric: smooth interface between two transparent media (Mitsuba 3 `dielectric`). The shading normal points to the
// exterior. Reflection or transmission is chosen with the Fresnel reflectance R.

#include "core/scene/bsdfs/fresnel.h"
#include "core/scene/bsdfs/parameters.h"
#include "core/scene/bsdfs/scattering.h"

namespace ulam {

struct Dielectric {
    using Parameters = InterfaceParameters;
    explicit Dielectric(const Parameters& p)
        : ior(p.intIor / p.extIor),
          specularReflectance(p.specularReflectance),
          specularTransmittance(p.specularTransmittance) {}

    static constexpr bool hasDelta = true, hasSmooth = false, transmits = true;
    template <class V>
    static void textured(V& v) {
        v("specular_reflectance", &Dielectric::specularReflectance);
        v("specular_transmittance", &Dielectric::specularTransmittance);
    }

    double albedo() const { return std::max(maxComponent(specularReflectance), maxComponent(specularTransmittance)); }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        if (!matches(toLight.z, toCamera.z, lobe)) return Color<T>(T(0));
        const T r = reflectance(toLight.z, toCamera.z), eta2(etaSquared(toCamera.z > 0));
        return lobe == Lobe::DeltaReflection ? scaled(specularReflectance, r * eta2)
                                             : scaled(specularTransmittance, (T(1) - r) * eta2);
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        using std::abs;
        if (!matches(from.z, to.z, lobe)) return T(0);
        return probability(from, to, lobe) * abs(to.z) * etaSquared(to.z > 0);
    }

    template <class T>
    T probability(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        const T r = reflectance(from.z, to.z);
        return lobe == Lobe::DeltaReflection ? r : T(lobe == Lobe::DeltaTransmission ? 1 : 0) * (T(1) - r);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block&) const {
        if (from.z == 0) return std::nullopt;
        if (lobe == Lobe::DeltaReflection) return ScatterSample{reflected(from), lobe};
        if (lobe != Lobe::DeltaTransmission) return std::nullopt;
        const double relative = from.z > 0 ? 1 / ior : ior, cosTo = refractedCosine(from);
        if (!(cosTo > 0)) return std::nullopt;
        const float scale = float(-relative);
        return ScatterSample{Vec3f(scale * from.x, scale * from.y, float(from.z > 0 ? -cosTo : cosTo)).normalized(), lobe};
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const {
        if (from.z == 0) return std::nullopt;
        const double cosTo = refractedCosine(from);
        const double r = cosTo > 0 ? reflectance(double(from.z), from.z > 0 ? -cosTo : cosTo) : 1;
        return sampleLobe(from, u[2] < r ? Lobe::DeltaReflection : Lobe::DeltaTransmission, u);
    }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
        if (!matches(from.z, to.z, lobe)) return false;
        const double r = reflectance(double(from.z), double(to.z));
        if ((lobe == Lobe::DeltaReflection ? r : 1 - r) <= 0) return false;
        u[2] = lobe == Lobe::DeltaReflection ? u[2] * r : r + u[2] * (1 - r);
        return true;
    }

    double ior;  // interior over exterior
    Spectrum specularReflectance, specularTransmittance;

private:
    double ratio() const { return std::max(ior, 1 / ior); }
    /// η² of the medium on that side, in units of the exterior.
    double etaSquared(bool exterior) const { return exterior ? 1 : ior * ior; }

    /// |cosθ| beyond the interface; 0: total internal reflection.
    double refractedCosine(const Vec3f& from) const {
        const double c = from.z, relative = c > 0 ? 1 / ior : ior, c2 = 1 - (1 - c * c) * relative * relative;
        return c2 > 0 ? std::sqrt(c2) : 0;
    }

    template <class T>
    static bool matches(const T& a, const T& b, Lobe lobe) {
        return lobe == Lobe::DeltaReflection ? a * b > 0 : lobe == Lobe::DeltaTransmission && a * b < 0;
    }
    /// R from the cosines of either ray; symmetric in its arguments, so that both ends of a path agree on it.
    template <class T>
    T reflectance(const T& a, const T& b) const {
        using std::abs;
        const bool thinIsExterior = ior > 1;
        if ((a > 0) != (b > 0)) return fresnelFromThinSide(abs((a > 0) == thinIsExterior ? a : b), ratio());
        return fresnelDielectric(T(0.5) * (abs(a) + abs(b)), ratio(), (a > 0) == thinIsExterior);
    }
};

}  // namespace ulam
