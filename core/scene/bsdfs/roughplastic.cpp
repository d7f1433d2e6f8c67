#include "core/scene/bsdfs/roughplastic.h"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>

namespace ulam {
namespace {

using boost::math::quadrature::gauss, boost::math::quadrature::gauss_kronrod;

/// The interval [a, b] by a map whose derivative vanishes at both ends, so that roots there do no harm; nodes are dense there.
template <class Function>
auto mapped(Function&& f, double a, double b) {
    return [&f, a, b](double s) { return 6 * s * (1 - s) * (b - a) * f(a + (b - a) * s * s * (3 - 2 * s)); };
}

/// cosθ of the critical angle inside.
double criticalCosine(double ior) {
    return std::sqrt(1 - 1 / (ior * ior));
}

}  // namespace

// Over microfacet normals m ∝ (αr cosφ, αr sinφ, 1) with r = tan t: ∫∫ F(w·m) G1(o) D_w(m) dω_m, where o is w mirrored at
// m and D_w the density of visible normals. All bends of the integrand are ends of intervals: o leaves the surface for
// |φ| < φ_max(r), and reflection from inside is total beyond another azimuth.
double roughReflectance(const MicrofacetDistribution& d, double ior, bool exterior, double cosTheta) {
    const double alpha = d.alphaU, sinTheta = std::sqrt(std::max(0.0, 1 - cosTheta * cosTheta));
    const Vec3d w(sinTheta, 0, cosTheta);
    const auto overAzimuth = [&](double t) {
        const double r = std::tan(t), slope = alpha * r;
        const auto azimuth = [&](double numerator) { return std::acos(std::clamp(numerator / (slope * sinTheta), -1.0, 1.0)); };
        const auto integrand = [&](double phi) {
            const Vec3d m = Vec3d(slope * std::cos(phi), slope * std::sin(phi), 1).normalized(), o = mirroredAt(w, m);
            if (!(o.z > 0)) return 0.0;
            return fresnelDielectric(w.dot(m), ior, exterior) * o.z / d.projectedArea(o) * d.visible(w, m) * m.z * m.z * m.z;
        };
        const double end = azimuth(0.5 * cosTheta * (slope * slope - 1));
        const double total = exterior ? end : std::min(end, azimuth(criticalCosine(ior) * std::hypot(1, slope) - cosTheta));
        double sum = gauss<double, 15>::integrate(mapped(integrand, 0, total), 0.0, 1.0);
        if (total < end) sum += gauss<double, 15>::integrate(mapped(integrand, total, end), 0.0, 1.0);
        return 2 * alpha * alpha * r * (1 + r * r) * sum;
    };
    // Tilts of the microfacet beyond which φ_max shrinks from π, and is 0; and, in the plane of w, those at which
    // reflection from inside begins or ends to be total.
    const auto boundAt = [&](double tilt) { return std::atan2(std::sin(tilt), alpha * std::cos(tilt)); };
    const double theta = std::acos(cosTheta), last = boundAt(0.5 * theta + 0.25 * kPi);
    std::array bounds{0.0, boundAt(0.25 * kPi - 0.5 * theta), last, last, last};
    if (!exterior) {
        const double critical = std::acos(criticalCosine(ior));
        bounds[3] = std::min(last, boundAt(std::abs(theta - critical)));
        bounds[4] = std::min(last, boundAt(std::min(theta + critical, 0.5 * kPi)));
        std::sort(bounds.begin(), bounds.end());
    }
    double sum = 0;
    for (size_t i = 0; i + 1 < bounds.size(); ++i)
        if (bounds[i] < bounds[i + 1])
            sum += gauss_kronrod<double, 15>::integrate(mapped(overAzimuth, bounds[i], bounds[i + 1]), 0, 1, 5, 1e-5);
    return sum;
}

// As above, with the refracted direction o below the surface. Every microfacet on w's side takes part: those tilted by less
// than π/2 − θ at all azimuths.
double roughTransmittance(const MicrofacetDistribution& d, double ior, double cosTheta) {
    const double alpha = d.alphaU, sinTheta = std::sqrt(std::max(0.0, 1 - cosTheta * cosTheta));
    const Vec3d w(sinTheta, 0, cosTheta);
    const auto overAzimuth = [&](double t) {
        const double r = std::tan(t), slope = alpha * r;
        const auto integrand = [&](double phi) {
            const Vec3d m = Vec3d(slope * std::cos(phi), slope * std::sin(phi), 1).normalized();
            const double c = std::max(0.0, w.dot(m));
            const Vec3d o = m * (c / ior - std::sqrt(1 - (1 - c * c) / (ior * ior))) - w / ior;
            if (!(o.z < 0)) return 0.0;
            return (1 - fresnelDielectric(c, ior, true)) * -o.z / d.projectedArea(-o) * d.visible(w, m) * m.z * m.z * m.z;
        };
        const double end = std::acos(std::clamp(-cosTheta / (slope * sinTheta), -1.0, 1.0));
        return 2 * alpha * alpha * r * (1 + r * r) * gauss<double, 15>::integrate(mapped(integrand, 0, end), 0.0, 1.0);
    };
    const double last = 0.5 * kPi, full = std::atan2(cosTheta, alpha * sinTheta);
    double sum = 0;
    for (const auto& [a, b] : {std::pair(0.0, full), {full, last}})
        if (a < b) sum += gauss_kronrod<double, 15>::integrate(mapped(overAzimuth, a, b), 0, 1, 5, 1e-5);
    return sum;
}

double roughInternalReflectance(const MicrofacetDistribution& d, double ior) {
    constexpr int kCosines = 64;
    double sum = 0;
    for (int i = 0; i < kCosines; ++i) {
        const double cosTheta = 1e-6 + (1 - 1e-6) * i / (kCosines - 1);
        sum += 2 * cosTheta * roughReflectance(d, ior, false, cosTheta);
    }
    return sum / kCosines;
}

RoughTransmittance::RoughTransmittance(const MicrofacetDistribution& distribution, double ior)
    : alpha_(distribution.alphaU), scale_((kNodes - 1) / std::log1p(1 / alpha_)) {
    for (int i = 0; i < kNodes; ++i) {
        const double cosTheta = std::min(1.0, alpha_ * std::expm1(i / scale_));
        nodes_[size_t(i)] = float(roughTransmittance(distribution, ior, cosTheta));
    }
}

}  // namespace ulam
