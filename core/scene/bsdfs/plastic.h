#pragma once
// plastic: a smooth dielectric coat over a diffuse base, on the side of the shading normal (Mitsuba 3 `plastic`; coat.h).
// Mitsuba fits the coat's reflectance for diffuse light from inside; here it is the integral.

#include "core/scene/bsdfs/coat.h"
#include "core/scene/bsdfs/fresnel.h"
#include "core/scene/bsdfs/parameters.h"

namespace ulam {

struct Plastic {
    using Parameters = CoatParameters;
    explicit Plastic(const Parameters& p)
        : coat{p.intIor / p.extIor, diffuseFresnelFromInside(p.intIor / p.extIor), p.nonlinear},
          diffuseReflectance(p.diffuseReflectance),
          specularReflectance(p.specularReflectance) {}

    static constexpr bool hasDelta = true, hasSmooth = true, transmits = false;

    template <class V>
    static void textured(V& v) {
        v("diffuse_reflectance", &Plastic::diffuseReflectance);
        v("specular_reflectance", &Plastic::specularReflectance);
    }

    double albedo() const { return std::max(maxComponent(specularReflectance), maxComponent(diffuseReflectance)); }

    double smoothShare(const Vec3f& from) const { return from.z > 0 ? 1 - coatShare(double(from.z)) : 0; }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        if (!(toLight.z > 0 && toCamera.z > 0)) return Color<T>(T(0));
        if (lobe == Lobe::DeltaReflection)
            return scaled(specularReflectance, reflectance(T(0.5) * (toLight.z + toCamera.z)));
        if (lobe != Lobe::Smooth) return Color<T>(T(0));
        return scaled(coat.base(diffuseReflectance), (T(1) - reflectance(toLight.z)) * (T(1) - reflectance(toCamera.z)));
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        if (!(from.z > 0 && to.z > 0)) return T(0);
        const T chosen = probability(from, to, lobe);
        return lobe == Lobe::DeltaReflection ? chosen * to.z : chosen * cosineHemispherePdf(to.z);
    }

    template <class T>
    T probability(const Direction<T>& from, const Direction<T>&, Lobe lobe) const {
        if (!(from.z > 0)) return T(0);
        if (lobe == Lobe::DeltaReflection) return coatShare(from.z);
        return lobe == Lobe::Smooth ? T(1) - coatShare(from.z) : T(0);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const {
        if (!(from.z > 0)) return std::nullopt;
        if (lobe == Lobe::DeltaReflection) return ScatterSample{reflected(from), lobe};
        if (lobe == Lobe::Smooth) return ScatterSample{squareToCosineHemisphere(u[0], u[1]), lobe};
        return std::nullopt;
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const {
        if (!(from.z > 0)) return std::nullopt;
        return sampleLobe(from, u[2] < coatShare(double(from.z)) ? Lobe::DeltaReflection : Lobe::Smooth, u);
    }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
        if (!(from.z > 0 && to.z > 0)) return false;
        const double share = coatShare(double(from.z));
        if (lobe == Lobe::DeltaReflection && share > 0) {
            u[2] *= share;
            return true;
        }
        if (lobe != Lobe::Smooth || share >= 1) return false;
        const Sample2 s = cosineHemisphereToSquare(to);
        u[0] = s.u;
        u[1] = s.v;
        u[2] = share + u[2] * (1 - share);
        return true;
    }

    Coat coat;
    Spectrum diffuseReflectance, specularReflectance;

private:
    template <class T>
    T reflectance(T cosTheta) const {
        return fresnelDielectric(cosTheta, coat.ratio(), coat.thinOutside());
    }
    template <class T>
    T coatShare(T cosTheta) const {
        return coatProbability(reflectance(cosTheta), specularReflectance, diffuseReflectance);
    }
};

}  // namespace ulam
