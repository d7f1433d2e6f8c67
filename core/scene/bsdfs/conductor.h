#pragma once
// conductor: smooth metal on the side of the shading normal (Mitsuba 3 `conductor`).

#include "core/scene/bsdfs/fresnel.h"
#include "core/scene/bsdfs/parameters.h"
#include "core/scene/bsdfs/scattering.h"

namespace ulam {

struct Conductor {
    using Parameters = MetalParameters;
    explicit Conductor(const Parameters& p) : eta(p.eta), k(p.k), specularReflectance(p.specularReflectance) {}

    static constexpr bool hasDelta = true, hasSmooth = false, transmits = false;
    template <class V>
    static void textured(V& v) {
        v("eta", &Conductor::eta);
        v("k", &Conductor::k);
        v("specular_reflectance", &Conductor::specularReflectance);
    }

    double albedo() const { return maxComponent(specularReflectance); }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        if (lobe != Lobe::DeltaReflection || !(toLight.z > 0 && toCamera.z > 0)) return Color<T>(T(0));
        return scaled(specularReflectance, T(1)) * fresnelConductor(toLight.z, eta, k);
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        return lobe == Lobe::DeltaReflection && from.z > 0 && to.z > 0 ? to.z : T(0);
    }

    template <class T>
    T probability(const Direction<T>&, const Direction<T>&, Lobe lobe) const {
        return T(lobe == Lobe::DeltaReflection ? 1 : 0);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block&) const {
        if (lobe != Lobe::DeltaReflection || !(from.z > 0)) return std::nullopt;
        return ScatterSample{reflected(from), Lobe::DeltaReflection};
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const { return sampleLobe(from, Lobe::DeltaReflection, u); }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block&) const {
        return lobe == Lobe::DeltaReflection && from.z > 0 && to.z > 0;
    }

    Spectrum eta, k, specularReflectance;
};

}  // namespace ulam
