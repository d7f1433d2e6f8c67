#pragma once
// roughdiffuse: V-grooves of Lambertian facets on the side of the shading normal (Oren & Nayar 1994, "Generalization of
// Lambert's reflectance model": the functional approximation, shadowing, masking and one interreflection included, or with
// `use_fast_approx` the qualitative model; Mitsuba 0.6 `roughdiffuse`). As in Mitsuba, the standard deviation of the facets'
// angles is σ = alpha/√2 radians, which matches Beckmann's roughness up to about 0.5.
//
// A fit to integrals: at grazing angles it gives back up to 5 % more than it receives, and where dark grooves face away from
// each other it falls below 0, where it is cut.

#include "core/scene/bsdfs/diffuse.h"

namespace ulam {

struct RoughDiffuse : CosineSampling {
    struct Parameters : Diffuse::Parameters {
        double alpha = 0.2;
        bool useFastApprox = false;
        template <class V>
        void describe(V& v) {
            Diffuse::Parameters::describe(v);
            v("alpha", alpha, {.help = "roughness: root mean square slope of the facets", .min = 0, .max = 1});
            v("use_fast_approx", useFastApprox, {.help = "the qualitative model: no interreflection"});
        }
    };
    explicit RoughDiffuse(const Parameters& p) : reflectance(p.reflectance), alpha(p.alpha), qualitative(p.useFastApprox) {}

    static constexpr bool hasDelta = false, hasSmooth = true, transmits = false;

    template <class V>
    static void textured(V& v) {
        v("reflectance", &RoughDiffuse::reflectance);
        v("alpha", &RoughDiffuse::alpha);
    }

    double albedo() const { return 1.06 * maxComponent(reflectance); }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        if (lobe != Lobe::Smooth || !(toLight.z > 0 && toCamera.z > 0)) return Color<T>(T(0));
        const Geometry<T> g(toLight, toCamera);
        const double s2 = 0.5 * alpha * alpha, c1 = 1 - 0.5 * s2 / (s2 + 0.33), c2 = 0.45 * s2 / (s2 + 0.09);
        if (qualitative) {
            const T facing = g.cosPhi > 0 ? g.cosPhi * g.sinLarge * g.tanSmall : T(0);
            return scaled(reflectance, (T(c1) + facing * c2) * (1 / kPi));
        }
        const T small = g.small * (2 / kPi), product = small * g.large * (2 / kPi);
        const T grooves = g.cosPhi > 0 ? g.sinLarge : g.sinLarge - small * small * small;
        const T across = T(1) - (g.cosPhi > 0 ? g.cosPhi : -g.cosPhi);
        const T once = T(c1) + g.cosPhi * grooves * g.tanSmall * c2 +
                       across * product * product * g.tanHalf * (0.125 * s2 / (s2 + 0.09));
        const T twice = (T(1) - g.cosPhi * small * small) * (0.17 * s2 / (s2 + 0.13));
        Color<T> f;
        for (int i = 0; i < 3; ++i) {
            const T all = once + twice * reflectance[i];
            f[i] = all > 0 ? all * (reflectance[i] / kPi) : T(0);
        }
        return f;
    }

    Spectrum reflectance;
    double alpha;
    bool qualitative;

private:
    /// Both angles with the normal, the larger and the smaller one (α and β of the paper), and what the formulas need of them.
    template <class T>
    struct Geometry {
        T cosPhi;  ///< of the difference of azimuths
        T large, small, sinLarge, tanSmall;
        T tanHalf;  ///< tan((α + β)/2)

        Geometry(const Direction<T>& a, const Direction<T>& b) {
            using std::atan2, std::sqrt;
            const T sinA = sqrt(a.x * a.x + a.y * a.y), sinB = sqrt(b.x * b.x + b.y * b.y), both = sinA * sinB;
            cosPhi = both > 0 ? (a.x * b.x + a.y * b.y) / both : T(0);
            const T angleA = atan2(sinA, a.z), angleB = atan2(sinB, b.z);
            const bool first = angleA > angleB;
            large = first ? angleA : angleB;
            small = first ? angleB : angleA;
            sinLarge = first ? sinA : sinB;
            tanSmall = first ? sinB / b.z : sinA / a.z;
            tanHalf = (sinA + sinB) / (a.z + b.z);
        }
    };
};

}  // namespace ulam
