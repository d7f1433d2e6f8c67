#pragma once
// A disc at infinity with the same radiance everywhere, and directions drawn uniformly from it.

#include "core/base/warp.h"

namespace ulam {

class SunDisc {
public:
    /// `radius`: half the angle it is seen under, in radians, from kSmallestRadius to π/2.
    SunDisc(const Vec3f& direction, double radius, const Spectrum& radiance);

    /// Directions are floats, which are 6·10⁻⁸ apart: in smaller discs there are too few.
    static constexpr double kSmallestRadius = 5e-5;

    const Vec3f& direction() const { return direction_; }
    const Spectrum& radiance() const { return radiance_; }
    double radius() const { return radius_; }
    double solidAngle() const { return 2 * kPi * height_; }

    /// Is a unit direction inside? In double precision: a float's error of 10⁻⁷ in the cosine would be 1 % of the sun.
    bool holds(const Vec3f& w) const {
        const Vec3d d(w);
        return d.dot(axis_) > 0 && d.cross(axis_).length2() <= sine2_ * d.length2();
    }

    /// Uniform per solid angle, with density 1 / solidAngle(). Always inside, as `holds` judges it.
    Vec3f sample(double u, double v) const;
    Sample2 invert(const Vec3f& w) const;

private:
    Vec3f direction_;
    Vec3d axis_, s_, t_;  ///< orthonormal
    double radius_;
    double height_;       ///< 1 − cos(radius)
    double sine2_;        ///< sin²(radius)
    Spectrum radiance_;
};

}  // namespace ulam
