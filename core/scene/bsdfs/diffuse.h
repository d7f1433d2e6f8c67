#pragma once
// diffuse: Lambertian reflection on the side of the shading normal (Mitsuba 3 `diffuse`).

#include "core/scene/bsdfs/scattering.h"

namespace ulam {

/// Directions with density cosθ/π on the side of the shading normal.
struct CosineSampling {
    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        return lobe == Lobe::Smooth && from.z > 0 ? cosineHemispherePdf(to.z) : T(0);
    }

    template <class T>
    T probability(const Direction<T>&, const Direction<T>&, Lobe lobe) const {
        return T(lobe == Lobe::Smooth ? 1 : 0);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const {
        if (lobe != Lobe::Smooth || !(from.z > 0)) return std::nullopt;
        return ScatterSample{squareToCosineHemisphere(u[0], u[1]), Lobe::Smooth};
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const { return sampleLobe(from, Lobe::Smooth, u); }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
        if (lobe != Lobe::Smooth || !(from.z > 0 && to.z > 0)) return false;
        const Sample2 s = cosineHemisphereToSquare(to);
        u[0] = s.u;
        u[1] = s.v;
        return true;
    }
};

struct Diffuse : CosineSampling {
    struct Parameters {
        Spectrum reflectance{0.5, 0.5, 0.5};
        template <class V>
        void describe(V& v) {
            v("reflectance", reflectance, {.help = "fraction of the light that is reflected", .min = 0, .max = 1});
        }
    };
    explicit Diffuse(const Parameters& p) : reflectance(p.reflectance) {}

    static constexpr bool hasDelta = false, hasSmooth = true, transmits = false;
    template <class V>
    static void textured(V& v) {
        v("reflectance", &Diffuse::reflectance);
    }

    double albedo() const { return maxComponent(reflectance); }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        if (lobe != Lobe::Smooth || !(toLight.z > 0 && toCamera.z > 0)) return Color<T>(T(0));
        return Color<T>(T(reflectance.x), T(reflectance.y), T(reflectance.z)) * T(1 / kPi);
    }

    Spectrum reflectance;
};

}  // namespace ulam
