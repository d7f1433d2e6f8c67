#pragma once
// roughplastic: a rough dielectric coat over a diffuse base, on the side of the shading normal (Mitsuba 3 `roughplastic`;
// coat.h). T(θ) is what microfacets refract and is not masked on its way down; light that is masked is lost. It is integrated
// over the distribution once and tabulated. R_i is Mitsuba's too: the mean of 2 cosθ R(θ) over 64 equidistant cosines from
// 10⁻⁶ to 1. As a rule for the integral it is 0.007 (alpha 0.2) to 0.011 (alpha → 0) too small, so that the base comes out
// some 1.4 to 2.7 % darker than under `plastic` with the same parameters.
//
// One smooth lobe, sampled as a mixture: u[2] chooses between the coat's reflection and the base.

#include <array>

#include "core/base/error.h"
#include "core/scene/bsdfs/coat.h"
#include "core/scene/bsdfs/fresnel.h"
#include "core/scene/bsdfs/microfacet.h"
#include "core/scene/bsdfs/parameters.h"

namespace ulam {

/// T(θ) of a rough coat from outside. Nodes are equidistant in log(1 + cosθ/α): at grazing angles R changes over the width
/// of α, further up as Fresnel's reflectance does. Between them a cubic with continuous derivative.
class RoughTransmittance {
public:
    RoughTransmittance(const MicrofacetDistribution& distribution, double ior);

    template <class T>
    T operator()(T cosTheta) const {
        using std::log;
        const T x = log(T(1) + cosTheta * (1 / alpha_)) * scale_;
        const int i = std::clamp(int(double(x)), 0, kNodes - 2);
        const T t = x - T(i), t2 = t * t, t3 = t2 * t;
        const double a = nodes_[size_t(i)], b = nodes_[size_t(i) + 1], slopeA = slope(i), slopeB = slope(i + 1);
        return T(a) + t * slopeA + t2 * (3 * (b - a) - 2 * slopeA - slopeB) + t3 * (2 * (a - b) + slopeA + slopeB);
    }

private:
    static constexpr int kNodes = 200;

    double slope(int i) const {
        const auto at = [this](int j) { return double(nodes_[size_t(j)]); };
        // At the ends from four nodes, in a form that is exact for cubics.
        const auto end = [&](int step) { return (-11 * at(i) + 18 * at(i + step) - 9 * at(i + 2 * step) + 2 * at(i + 3 * step)) / 6; };
        return i == 0 ? end(1) : i == kNodes - 1 ? -end(-1) : 0.5 * (at(i + 1) - at(i - 1));
    }

    double alpha_, scale_;
    std::array<float, kNodes> nodes_;
};

/// R(θ) of an isotropic rough interface: the part of light that is reflected off visible microfacets and not masked on its
/// way out; `exterior` says from which side it comes.
double roughReflectance(const MicrofacetDistribution& distribution, double ior, bool exterior, double cosTheta);
/// T(θ) from outside: the part that is refracted by visible microfacets and not masked on its way down.
double roughTransmittance(const MicrofacetDistribution& distribution, double ior, double cosTheta);
/// R_i: of diffuse light from inside.
double roughInternalReflectance(const MicrofacetDistribution& distribution, double ior);

struct RoughPlastic {
    struct Parameters : CoatParameters {
        std::string distribution = "beckmann";
        double alpha = 0.1;
        bool sampleVisible = true;
        template <class V>
        void describe(V& v) {
            CoatParameters::describe(v);
            v("distribution", distribution, {.help = "of the microfacet normals", .choices = {"beckmann", "ggx"}});
            v("alpha", alpha, {.help = "roughness; of Beckmann the root mean square slope", .min = 1e-4, .max = 1});
            v("sample_visible", sampleVisible, {.help = "without effect: visible normals are always sampled"});
        }
        MicrofacetDistribution microfacets() const { return {MicrofacetDistribution::kindOf(distribution), alpha, alpha}; }
        /// The integrals are written for light that enters a denser coat: off a thinner one it may be reflected totally.
        double ior() const {
            if (intIor < extIor) fail(ExitCode::InvalidConfig, "roughplastic: int_ior must not be below ext_ior");
            return intIor / extIor;
        }
    };
    explicit RoughPlastic(const Parameters& p)
        : coat{p.ior(), roughInternalReflectance(p.microfacets(), p.ior()), p.nonlinear},
          diffuseReflectance(p.diffuseReflectance),
          specularReflectance(p.specularReflectance),
          distribution(p.microfacets()),
          transmittance(distribution, p.ior()) {}

    static constexpr bool hasDelta = false, hasSmooth = true, transmits = false;

    template <class V>
    static void textured(V& v) {
        v("diffuse_reflectance", &RoughPlastic::diffuseReflectance);
        v("specular_reflectance", &RoughPlastic::specularReflectance);
    }

    double albedo() const { return std::max(maxComponent(specularReflectance), maxComponent(diffuseReflectance)); }

    template <class T>
    Color<T> eval(const Direction<T>& toLight, const Direction<T>& toCamera, Lobe lobe) const {
        if (lobe != Lobe::Smooth || !(toLight.z > 0 && toCamera.z > 0)) return Color<T>(T(0));
        const HalfVector<T> h(toLight + toCamera);
        const T fresnel = fresnelDielectric(T(0.5) * h.length, coat.ratio(), coat.thinOutside());
        return scaled(specularReflectance, fresnel * roughReflection(distribution, toLight, toCamera, h.m)) +
               scaled(coat.base(diffuseReflectance), transmittance(toLight.z) * transmittance(toCamera.z));
    }

    template <class T>
    T pdf(const Direction<T>& from, const Direction<T>& to, Lobe lobe) const {
        if (lobe != Lobe::Smooth || !(from.z > 0 && to.z > 0)) return T(0);
        const Mixture<T> mixture(*this, from, to);
        return mixture.coat + mixture.base;
    }

    template <class T>
    T probability(const Direction<T>&, const Direction<T>&, Lobe lobe) const {
        return T(lobe == Lobe::Smooth ? 1 : 0);
    }

    std::optional<ScatterSample> sampleLobe(const Vec3f& from, Lobe lobe, const Block& u) const {
        if (lobe != Lobe::Smooth || !(from.z > 0)) return std::nullopt;
        if (!(u[2] < coatShare(double(from.z)))) return ScatterSample{squareToCosineHemisphere(u[0], u[1]), Lobe::Smooth};
        const Vec3d w(from);
        const Vec3f to(mirroredAt(w, distribution.sampleVisible(w, u[0], u[1])));
        if (!(to.z > 0)) return std::nullopt;
        return ScatterSample{to, Lobe::Smooth};
    }
    std::optional<ScatterSample> sample(const Vec3f& from, const Block& u) const { return sampleLobe(from, Lobe::Smooth, u); }

    bool invert(const Vec3f& from, const Vec3f& to, Lobe lobe, Block& u) const {
        if (lobe != Lobe::Smooth || !(from.z > 0 && to.z > 0)) return false;
        const Vec3d w(from), t(to);
        const Mixture<double> mixture(*this, w, t);
        const double share = coatShare(w.z), at = u[2] * (mixture.coat + mixture.base);
        // Either part may have made this direction, with probabilities as their densities.
        const bool byCoat = at < mixture.coat;
        const Sample2 s = byCoat ? distribution.invertVisible(w, HalfVector<double>(w + t).m) : cosineHemisphereToSquare(to);
        u[0] = s.u;
        u[1] = s.v;
        u[2] = byCoat ? share * (at / mixture.coat) : share + (1 - share) * ((at - mixture.coat) / mixture.base);
        return byCoat || mixture.base > 0;
    }

    Coat coat;
    Spectrum diffuseReflectance, specularReflectance;
    MicrofacetDistribution distribution;
    RoughTransmittance transmittance;

private:
    template <class T>
    T coatShare(T cosTheta) const {
        return coatProbability(T(1) - transmittance(cosTheta), specularReflectance, diffuseReflectance);
    }

    /// The parts of the density of `to`.
    template <class T>
    struct Mixture {
        T coat, base;

        Mixture(const RoughPlastic& bsdf, const Direction<T>& from, const Direction<T>& to) {
            const T share = bsdf.coatShare(from.z);
            coat = share * roughReflectionPdf(bsdf.distribution, from, HalfVector<T>(from + to).m);
            base = (T(1) - share) * cosineHemispherePdf(to.z);
        }
    };
};

}  // namespace ulam
