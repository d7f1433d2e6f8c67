#pragma once
// Perturbations (Veach 1997, §11.4.3): a direction is changed a little and followed through the same specular bounces.

#include "core/mcmc/path_edit.h"

namespace ulam {

/// A length between `smallest` and `largest`, its logarithm uniform; turned by a uniform angle it is a step in the plane.
class ExponentialStep {
public:
    ExponentialStep() = default;
    /// Rounding: of the single-precision geometry a length is measured in; widens the ends.
    ExponentialStep(double smallest, double largest, double rounding)
        : largest_(largest), from_(smallest - rounding), to_(largest + rounding), logRatio_(std::log(largest / smallest)) {}

    double sample(double u) const { return largest_ * std::exp(-logRatio_ * u); }
    /// Density of the length.
    double pdf(double length) const { return length > 0 && length > from_ && length < to_ ? 1 / (length * logRatio_) : 0; }

private:
    double largest_ = 0, from_ = 0, to_ = 0, logRatio_ = 0;
};

/// Steps of the raster position.
struct RasterPerturbation {
    RasterPerturbation() = default;
    RasterPerturbation(double smallest, double largest) : radius{smallest, largest, 2e-3} {}

    ExponentialStep radius;  ///< pixels

    Vec2f sample(const Vec2f& from, const Block& u) const {
        const double r = radius.sample(u[0]), phi = 2 * kPi * u[1];
        return {float(from.x + r * std::cos(phi)), float(from.y + r * std::sin(phi))};
    }
    /// Per pixel².
    double pdf(const Vec2f& from, const Vec2f& to) const {
        const double x = double(to.x) - from.x, y = double(to.y) - from.y, r = std::sqrt(x * x + y * y);
        return radius.pdf(r) / (2 * kPi * r);
    }
};

/// Steps of the point on a thin lens. A pinhole stays where it is.
struct AperturePerturbation {
    /// In units of the aperture's radius.
    static inline const ExponentialStep kStep{0.01, 1, 2e-6};

    /// From u[2] and u[3]; false where the step leaves the lens.
    static bool sample(const Perspective& sensor, const Vertex& from, const Block& u, Vertex& to) {
        if (sensor.positionIsDelta()) return to = from, true;
        const Vec2f p = sensor.onDisc(from);
        const double r = kStep.sample(u[2]), phi = 2 * kPi * u[3];
        const Vec2f q(float(p.x + r * std::cos(phi)), float(p.y + r * std::sin(phi)));
        to = sensor.lensPoint(q);
        return q.length2() < 1;
    }
    /// Per area of the lens; 1 for a pinhole.
    static double pdf(const Perspective& sensor, const Vertex& from, const Vertex& to) {
        if (sensor.positionIsDelta()) return 1;
        const double r = double(length(to.position - from.position)) / sensor.apertureRadius();
        return kStep.pdf(r) / (2 * kPi * r * sensor.apertureRadius() * sensor.apertureRadius());
    }
};

/// Steps of a direction.
struct AnglePerturbation {
    AnglePerturbation() = default;
    AnglePerturbation(double smallest, double largest) : angle{smallest, largest, 1e-5} {}

    ExponentialStep angle;  ///< radians

    Vec3f sample(const Vec3f& from, const Block& u) const {
        const double theta = angle.sample(u[0]), phi = 2 * kPi * u[1];
        const float s = float(std::sin(theta));
        return normalize(Frame(from).toWorld({s * float(std::cos(phi)), s * float(std::sin(phi)), float(std::cos(theta))}));
    }
    /// Per solid angle.
    double pdf(const Vec3f& from, const Vec3f& to) const {
        const Imath::V3d c = Imath::V3d(from).cross(Imath::V3d(to));
        const double s = c.length(), theta = std::atan2(s, double(dot(from, to)));
        return s > 0 ? angle.pdf(theta) / (2 * kPi * s) : 0;
    }
};

/// Between vertices that lie very close together, the direction found from their places may be further from the one that
/// was drawn than a step's rounding allows. Such a proposal is impossible by its own density, and so is the way back.
inline void rejectIfRoundedAway(Proposal& p) {
    if (p.logForward == -std::numeric_limits<double>::infinity()) p.reject = Reject::NotInvertible;
}

/// Indices of the vertices next to the camera: the first that is not delta, counted from the camera (0 if none is).
inline int firstSmoothFromCamera(const Path& path) {
    int i = path.length() - 1;
    while (i > 0 && isDelta(path[i].lobe)) --i;
    return i;
}

/// log density of x_i by a walk from the camera that was told the delta lobe at x_{i+1}.
inline double logFollowedFromCamera(const Scene& scene, const Path& path, const PathFactors& f, int i) {
    return std::log(f.fromCamera(i) / lobeProbability(scene, path[i + 1], f.edge[i + 1].direction, -f.edge[i].direction));
}
inline double logFollowedFromLight(const Scene& scene, const Path& path, const PathFactors& f, int i) {
    return std::log(f.fromLight(i) / lobeProbability(scene, path[i - 1], -f.edge[i - 2].direction, f.edge[i - 1].direction));
}

}  // namespace ulam
