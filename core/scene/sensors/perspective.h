#pragma once
// perspective: a pinhole camera (Mitsuba 3 `perspective`). Camera space looks along +z with y up and, seen in the image,
// x to the left: Mitsuba's convention.
//
// Raster coordinates are pixels, (0, 0) at the image's upper left corner. The sensor responds to the raster window
// `window`, which reaches beyond the image by what the reconstruction filter needs. Its importance W_e(w) is normalised
// so that ∫ W_e dω over the window is 1: a path's f then is a density over the window, and W_e is at the same time the
// density of a direction when the raster position is uniform.

#include "core/base/random.h"
#include "core/scene/emitters/emission.h"

#include <Imath/ImathBox.h>

#include <optional>

namespace ulam {

/// The image is the part crop* of a full film of width × height pixels; raster coordinates start at the crop's corner.
struct FilmSize {
    int width = 768, height = 576;
    int cropOffsetX = 0, cropOffsetY = 0, cropWidth = 768, cropHeight = 576;
};

class Perspective {
public:
    struct Parameters {
        double fov = 0;
        std::string fovAxis = "x";
        double nearClip = 1e-2, farClip = 1e4;
        double principalPointOffsetX = 0, principalPointOffsetY = 0;
        template <class V>
        void describe(V& v) {
            v("fov", fov, {.help = "field of view along fov_axis; 0: what focal_length gives", .unit = "degrees", .min = 0, .max = 180, .maxExclusive = true});
            v("fov_axis", fovAxis, {.help = "axis that fov spans", .choices = {"x", "y", "diagonal", "smaller", "larger"}});
            v("near_clip", nearClip, {.help = "no effect: nothing in front of the pinhole is clipped", .min = 0});
            v("far_clip", farClip, {.help = "no effect: nothing is too far", .min = 0});
            v("principal_point_offset_x", principalPointOffsetX, {.help = "shift of the principal point, as a fraction of the image width"});
            v("principal_point_offset_y", principalPointOffsetY, {.help = "shift of the principal point, as a fraction of the image height"});
        }
    };

    /// `toWorld` maps camera space to world space; `margin` is how far (pixels) the window reaches beyond the image.
    Perspective(const Parameters& parameters, const Matrix4& toWorld, const FilmSize& film, float margin);

    static constexpr bool positionIsDelta = true;

    int width() const { return film_.cropWidth; }
    int height() const { return film_.cropHeight; }
    const Imath::Box2f& window() const { return window_; }
    double windowArea() const { return windowArea_; }

    Vertex samplePosition(const Block&) const {
        Vertex v{};
        v.position = position_;
        v.kind = Vertex::Kind::Point;
        v.shape = kNone;
        return v;
    }
    double positionPdf(const Vertex&) const { return 1; }

    /// The direction of a raster position.
    Vec3f direction(const Vec2f& raster) const {
        const float x = float(x0_ + dx_ * raster.x), y = float(y0_ + dy_ * raster.y);
        return normalize(unitX_ * x + unitY_ * y + unitZ_);
    }
    /// Raster position of a direction out of the pinhole; nothing if it misses the window.
    std::optional<Vec2f> raster(const Vec3f& w) const {
        const double z = dot(w, unitZ_);
        if (z <= 0) return std::nullopt;
        const Vec2f r{float((dot(w, unitX_) / z - x0_) / dx_), float((dot(w, unitY_) / z - y0_) / dy_)};
        if (r.x < window_.min.x || r.x >= window_.max.x || r.y < window_.min.y || r.y >= window_.max.y) return std::nullopt;
        return r;
    }
    /// Uniform over the window: numbers u[0], u[1].
    Vec2f sampleRaster(const Block& u) const {
        return {float(window_.min.x + u[0] * (window_.max.x - window_.min.x)), float(window_.min.y + u[1] * (window_.max.y - window_.min.y))};
    }
    void invertRaster(const Vec2f& raster, Block& u) const {
        u[0] = (double(raster.x) - window_.min.x) / (double(window_.max.x) - window_.min.x);
        u[1] = (double(raster.y) - window_.min.y) / (double(window_.max.y) - window_.min.y);
    }
    /// W_e(w), per solid angle; 0 outside the window. Also the density of w under sampleRaster.
    double importance(const Vec3f& w) const {
        const double z = dot(w, unitZ_);
        return raster(w) ? importanceOnAxis_ / (z * z * z) : 0;
    }
    double directionPdf(const Vec3f& w) const { return importance(w); }

private:
    FilmSize film_;
    Imath::Box2f window_;
    double windowArea_;
    Vec3f position_, unitX_, unitY_, unitZ_;  // camera axes in world space
    // Point of a raster position on the camera's plane z = 1: x = x0 + dx·raster.x, y = y0 + dy·raster.y.
    double x0_, y0_, dx_, dy_;
    double importanceOnAxis_;  // 1 / area of the window on that plane
};

}  // namespace ulam
