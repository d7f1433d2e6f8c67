#include "core/scene/sun_disc.h"

namespace ulam {

SunDisc::SunDisc(const Vec3f& direction, double radius, const Spectrum& radiance)
    : direction_(direction),
      axis_(Vec3d(direction).normalized()),
      radius_(radius),
      height_(2 * std::sin(radius / 2) * std::sin(radius / 2)),
      sine2_(std::sin(radius) * std::sin(radius)),
      radiance_(radiance) {
    s_ = axis_.cross(std::abs(axis_.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)).normalized();
    t_ = axis_.cross(s_);
}

Vec3f SunDisc::sample(double u, double v) const {
    const Vec3d across = s_ * std::cos(2 * kPi * v) + t_ * std::sin(2 * kPi * v);
    // Where rounding to float moves a direction over the rim it is drawn 10⁻⁷ further inside: no light is lost.
    for (double height = u * height_;; height *= 1 - 2e-7 / radius_) {
        const Vec3f w(axis_ * (1 - height) + across * std::sqrt(height * (2 - height)));
        if (holds(w)) return w;
    }
}

Sample2 SunDisc::invert(const Vec3f& w) const {
    const Vec3d d = Vec3d(w).normalized();
    const double sine2 = d.cross(axis_).length2(), height = sine2 / (1 + std::sqrt(std::max(0.0, 1 - sine2)));
    return {std::clamp(height / height_, 0.0, 0x1.fffffffffffffp-1), inverseAzimuth(d.dot(s_), d.dot(t_))};
}

}  // namespace ulam
