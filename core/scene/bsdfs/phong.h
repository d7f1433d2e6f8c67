#pragma once
// phong: a diffuse base and a cosine lobe around the mirror direction, on the side of the shading normal (Lafortune & Willems
// 1994, "Using the modified Phong reflectance model for physically based rendering"; Mitsuba 0.6 `phong`):
// f = k_d/π + k_s (n + 2)/(2π) cosⁿα, α between one direction and the mirrored other. For k_d + k_s ≤ 1 it conserves energy; of
// the lobe's light, what would go below the surface is lost.
//
// One smooth lobe, sampled as a mixture: u[2] chooses between the cosine lobe, with density (n + 1)/(2π) cosⁿα, and the base.

#include "core/scene/bsdfs/mixture.h"
#include "core/scene/bsdfs/parameters.h"
#include "core/scene/bsdfs/scattering.h"

namespace ulam {

struct Phong {
    struct Parameters : GlossParameters {
        double exponent = 30;
        template <class V>
        void describe(V& v) {
            GlossParameters::describe(v);
            v("exponent", exponent, {.help = "of the cosine: the larger, the narrower the lobe", .min = 0, .max = 1e6});
        }
    };
    explicit Phong(const Parameters& p)
        : diffuseReflectance(p.diffuse("phong")), specularReflectance(p.specularReflectance), exponent(p.exponent) {}

    static constexpr bool hasDelta = false, hasSmooth = true, transmits = false;

    template <class V>
    static void textured(V& v) {
        v("diffuse_reflectance", &Phong::diffuseReflectance);
        v("specular_reflectance", &Phong::specularReflectance);
        v("exponent", &Phong::exponent);
    }

    double albedo() const { return maxComponent(diffuseReflectance + specularReflectance); }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        if (lobe != Lobe::Smooth || !(toLight.z > 0 && toCamera.z > 0)) return Color<T>(T(0));
        const T gloss = cosinePower(toLight, toCamera) * ((exponent + 2) / (2 * kPi));
        return scaled(diffuseReflectance, T(1 / kPi)) + scaled(specularReflectance, gloss);
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        if (lobe != Lobe::Smooth || !(from.z > 0 && to.z > 0)) return T(0);
        const auto [gloss, base] = partPdfs(from, to);
        return gloss + base;
    }

    template <class T>
    T probability(const Direction<T>&, const Direction<T>&, Lobe lobe) const {
        return T(lobe == Lobe::Smooth ? 1 : 0);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const {
        if (lobe != Lobe::Smooth || !(from.z > 0)) return std::nullopt;
        if (chosenPart(parts(), u[2]) == 1) return ScatterSample{squareToCosineHemisphere(u[0], u[1]), Lobe::Smooth};
        const double logCos = std::log(u[0]) / (exponent + 1), sine = std::sqrt(-std::expm1(2 * logCos)), phi = 2 * kPi * u[1];
        const Vec3f around(Vec3d(sine * std::cos(phi), sine * std::sin(phi), std::exp(logCos)));
        const Vec3f to = Frame(reflected(from)).toWorld(around);
        if (!(to.z > 0)) return std::nullopt;
        return ScatterSample{to, Lobe::Smooth};
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const { return sampleLobe(from, Lobe::Smooth, u); }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
        if (lobe != Lobe::Smooth || !(from.z > 0 && to.z > 0)) return false;
        const Vec3d w(from), t(to);
        const auto part = invertPart(parts(), partPdfs(w, t), u[2]);
        if (!part) return false;
        if (*part == 1) {
            const Sample2 s = cosineHemisphereToSquare(to);
            u[0] = s.u;
            u[1] = s.v;
        } else {
            const Vec3f around = Frame(reflected(from)).toLocal(to);
            u[0] = std::exp((exponent + 1) * std::log1p(-oneMinusCosine(w, t)));
            u[1] = inverseAzimuth(around.x, around.y);
        }
        return true;
    }

    Spectrum diffuseReflectance, specularReflectance;
    double exponent;

private:
    std::array<double, 2> parts() const {
        const double gloss = glossShare(diffuseReflectance, specularReflectance);
        return {gloss, 1 - gloss};
    }

    /// 1 − cosα. From the chord, which a direction's rounded length hardly changes.
    template <class T>
    static T oneMinusCosine(const Direction<T>& a, const Direction<T>& b) {
        const Direction<T> chord = a - reflected(b);
        return T(0.5) * chord.dot(chord);
    }
    template <class T>
    T cosinePower(const Direction<T>& a, const Direction<T>& b) const {
        using std::exp, std::log;
        const T cosine = T(1) - oneMinusCosine(a, b);
        return cosine > 0 ? exp(log(cosine) * exponent) : T(0);
    }
    /// The parts of the density of `to`.
    template <class T>
    std::array<T, 2> partPdfs(const Direction<T>& from, const Direction<T>& to) const {
        const auto [gloss, base] = parts();
        return {cosinePower(from, to) * (gloss * (exponent + 1) / (2 * kPi)), cosineHemispherePdf(to.z) * base};
    }
};

}  // namespace ulam
