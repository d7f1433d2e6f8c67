#include "core/scene/bsdfs/microfacet.h"

#include <boost/math/special_functions/erf.hpp>

namespace ulam {
namespace {

/// A direction seen in the frame in which the distribution is isotropic with alpha 1.
struct Stretched {
    double cosTheta, sinTheta, cosPhi, sinPhi;

    Stretched(const Vec3d& w, double alphaU, double alphaV) {
        const double x = alphaU * w.x, y = alphaV * w.y, s = std::hypot(x, y), length = std::hypot(s, w.z);
        cosTheta = w.z / length;
        sinTheta = s / length;
        cosPhi = s > 0 ? x / s : 1;
        sinPhi = s > 0 ? y / s : 0;
    }
};

/// Slopes of the visible normals of a Gaussian surface with P(p, q) = exp(−p² − q²)/π, p towards the viewer: the density
/// is (cosθ + p sinθ) P(p, q) where that is positive. So q is a Gaussian; this is the distribution of p.
class VisibleSlope {
public:
    VisibleSlope(double cosTheta, double sinTheta)
        : cosTheta_(cosTheta), sinTheta_(sinTheta), lowest_(std::max(-cosTheta / sinTheta, -kEnd)), total_(upTo(kEnd)) {}

    double cdf(double p) const { return std::clamp(upTo(p) / total_, 0.0, 1.0); }

    /// Newton's method, with bisection where it would leave the bracket.
    double quantile(double u) const {
        const double target = u * total_;
        double low = lowest_, high = kEnd;
        // Exact for normal and for grazing view.
        double p = cosTheta_ * boost::math::erf_inv(std::clamp(2 * u - 1, -1 + 1e-15, 1 - 1e-15)) +
                   sinTheta_ * std::sqrt(-std::log1p(-std::min(u, 1 - 1e-15)));
        for (int i = 0; i < 100; ++i) {
            if (!(p > low && p < high)) p = 0.5 * (low + high);
            const double error = upTo(p) - target;
            (error > 0 ? high : low) = p;
            const double step = error / ((cosTheta_ + p * sinTheta_) * std::exp(-p * p));
            p -= step;
            if (std::abs(step) < 1e-10 || !(high > low)) break;
        }
        return std::clamp(p, low, high);
    }

private:
    static constexpr double kEnd = 6;  // beyond lies 1e-16 of the distribution

    double upTo(double p) const {
        const double halfRootPi = 0.5 / std::numbers::inv_sqrtpi;
        return cosTheta_ * halfRootPi * (std::erf(p) - std::erf(lowest_)) +
               0.5 * sinTheta_ * (std::exp(-lowest_ * lowest_) - std::exp(-p * p));
    }

    double cosTheta_, sinTheta_, lowest_, total_;
};

}  // namespace

Vec3d MicrofacetDistribution::sampleVisible(const Vec3d& w, double u, double v) const {
    const Stretched s(w, alphaU, alphaV);
    if (kind == Kind::Beckmann) {
        const double p = VisibleSlope(s.cosTheta, s.sinTheta).quantile(u);
        const double q = boost::math::erf_inv(std::clamp(2 * v - 1, -1 + 1e-15, 1 - 1e-15));
        return Vec3d(alphaU * (s.cosPhi * p - s.sinPhi * q), alphaV * (s.sinPhi * p + s.cosPhi * q), 1).normalized();
    }
    // The normals seen along w lie half way to the uniformly distributed mirror directions (Dupuy & Benyoub 2023).
    const double z = (1 - u) * (1 + s.cosTheta) - s.cosTheta, r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * kPi * v;
    const double x = r * std::cos(phi) + s.sinTheta * s.cosPhi, y = r * std::sin(phi) + s.sinTheta * s.sinPhi;
    return Vec3d(alphaU * x, alphaV * y, z + s.cosTheta).normalized();
}

Sample2 MicrofacetDistribution::invertVisible(const Vec3d& w, const Vec3d& m) const {
    const Stretched s(w, alphaU, alphaV);
    if (kind == Kind::Beckmann) {
        const double x = m.x / (m.z * alphaU), y = m.y / (m.z * alphaV);
        return {VisibleSlope(s.cosTheta, s.sinTheta).cdf(s.cosPhi * x + s.sinPhi * y),
                0.5 * (1 + std::erf(s.cosPhi * y - s.sinPhi * x))};
    }
    const Vec3d view(s.sinTheta * s.cosPhi, s.sinTheta * s.sinPhi, s.cosTheta);
    const Vec3d mirror = mirroredAt(view, Vec3d(m.x / alphaU, m.y / alphaV, m.z).normalized());
    return {std::clamp((1 - mirror.z) / (1 + s.cosTheta), 0.0, 1.0), inverseAzimuth(mirror.x, mirror.y)};
}

}  // namespace ulam
