#include "core/scene/sensors/perspective.h"

#include "core/base/error.h"

namespace ulam {
namespace {

/// tan of half the horizontal field of view.
double tangentX(const Perspective::Parameters& p, double width, double height) {
    const double t = std::tan(p.fov * kPi / 360);
    const double aspect = width / height;
    if (p.fovAxis == "x") return t;
    if (p.fovAxis == "y") return t * aspect;
    if (p.fovAxis == "diagonal") return t * aspect / std::sqrt(1 + aspect * aspect);
    const bool wide = width > height;
    return (p.fovAxis == "larger") == wide || width == height ? t : t * aspect;
}

Vec3f axisOf(const Matrix4& m, const Imath::V3d& direction) {
    Imath::V3d out;
    m.multDirMatrix(direction, out);
    return Vec3f(out.normalized());
}

}  // namespace

Perspective::Perspective(const Parameters& p, const Aperture& aperture, const Matrix4& toWorld, const FilmSize& film, float margin)
    : film_(film),
      window_({-margin, -margin}, {float(film.cropWidth) + margin, float(film.cropHeight) + margin}),
      unitX_(axisOf(toWorld, {1, 0, 0})),
      unitY_(axisOf(toWorld, {0, 1, 0})),
      unitZ_(axisOf(toWorld, {0, 0, 1})),
      apertureRadius_(float(aperture.radius)),
      inverseFocus_(float(1 / aperture.focusDistance)),
      positionPdf_(aperture.radius > 0 ? 1 / (kPi * apertureRadius_ * apertureRadius_) : 1) {
    Imath::V3d origin;
    toWorld.multVecMatrix(Imath::V3d(0, 0, 0), origin);
    position_ = Vec3f(origin);
    const double t = tangentX(p, film.width, film.height);
    dx_ = -2 * t / film.width;
    dy_ = -2 * t / film.width;  // square pixels
    x0_ = t + dx_ * (film.cropOffsetX + p.principalPointOffsetX * film.width);
    y0_ = t * film.height / film.width + dy_ * (film.cropOffsetY + p.principalPointOffsetY * film.height);
    windowArea_ = double(window_.max.x - window_.min.x) * (window_.max.y - window_.min.y);
    pdfOnAxis_ = 1 / (windowArea_ * dx_ * dy_);
}

}  // namespace ulam
