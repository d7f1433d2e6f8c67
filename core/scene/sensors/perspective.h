#pragma once
// perspective and thinlens (Mitsuba 3): a camera that looks along +z with y up and, seen in the image, x to the left:
// Mitsuba's convention. Its aperture is a pinhole, or a disc around the origin of camera space in the plane z = 0 behind
// which everything at z = focus_distance is sharp.
//
// Raster coordinates are pixels, (0, 0) at the image's upper left corner. The sensor responds to the raster window
// `window`, which reaches beyond the image by what the reconstruction filter needs. Its importance W_e is normalised so
// that ∫ W_e |cosθ| dω dA over window and aperture is 1 (pinhole: ∫ W_e dω): a path's f then is a density over the window.

#include "core/base/non_finite.h"
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
            v("near_clip", nearClip, {.help = "no effect: nothing in front of the aperture is clipped", .min = 0});
            v("far_clip", farClip, {.help = "no effect: nothing is too far", .min = 0});
            v("principal_point_offset_x", principalPointOffsetX, {.help = "shift of the principal point, as a fraction of the image width"});
            v("principal_point_offset_y", principalPointOffsetY, {.help = "shift of the principal point, as a fraction of the image height"});
        }
    };
    /// A pinhole has radius 0, and its focus distance does not matter.
    struct Aperture {
        double radius = 0, focusDistance = 1;
    };

    /// `toWorld` maps camera space to world space; `margin` is how far (pixels) the window reaches beyond the image.
    Perspective(const Parameters& parameters, const Aperture& aperture, const Matrix4& toWorld, const FilmSize& film, float margin);

    /// Is the camera a pinhole?
    bool positionIsDelta() const { return apertureRadius_ == 0; }

    int width() const { return film_.cropWidth; }
    int height() const { return film_.cropHeight; }
    const Imath::Box2f& window() const { return window_; }
    double windowArea() const { return windowArea_; }
    /// The pinhole, or the middle of the aperture.
    const Vec3f& position() const { return position_; }
    float apertureRadius() const { return apertureRadius_; }
    /// Of the aperture: the direction of view.
    const Vec3f& axis() const { return unitZ_; }

    /// x_k from u[2] and u[3], uniform over the aperture.
    Vertex samplePosition(const Block& u) const { return positionIsDelta() ? lensPoint({0, 0}) : lensPoint(squareToDisc(u[2], u[3])); }
    /// The lens vertex at a point of the unit disc.
    Vertex lensPoint(const Vec2f& onDisc) const {
        Vertex v{};
        v.kind = positionIsDelta() ? Vertex::Kind::Point : Vertex::Kind::Lens;
        v.position = position_;
        if (!positionIsDelta()) v.position += (unitX_ * onDisc.x + unitY_ * onDisc.y) * apertureRadius_;
        v.normal = v.shadingNormal = unitZ_;
        v.shape = kNone;
        return v;
    }
    /// The point of the unit disc; the pinhole is its middle.
    Vec2f onDisc(const Vertex& lens) const {
        if (positionIsDelta()) return {0, 0};
        const Vec3f d = (lens.position - position_) / apertureRadius_;
        return {dot(d, unitX_), dot(d, unitY_)};
    }
    double positionPdf(const Vertex&) const { return positionPdf_; }
    void invertPosition(const Vertex& lens, Block& u) const {
        if (positionIsDelta()) return;
        const Vec2f d = onDisc(lens);
        const Sample2 s = discToSquare(d.x, d.y);
        u[2] = s.u;
        u[3] = s.v;
    }

    /// The direction from a point of the aperture that belongs to a raster position.
    Vec3f direction(const Vertex& lens, const Vec2f& raster) const {
        const float x = float(x0_ + dx_ * raster.x), y = float(y0_ + dy_ * raster.y);
        Vec3f d = unitX_ * x + unitY_ * y + unitZ_;
        if (!positionIsDelta()) d -= (lens.position - position_) * inverseFocus_;
        return normalize(d);
    }

    /// What the camera makes of a direction w out of a point of the aperture.
    struct Response {
        double importance = 0;  ///< W_e(w); 0 where w misses the window
        double pdf = 0;         ///< density of w, per solid angle, when the raster position is uniform over the window
        Vec2f raster{0, 0};     ///< where importance > 0
    };
    Response respond(const Vertex& lens, const Vec3f& w) const {
        const double z = dot(w, unitZ_);
        if (!(z > 0)) return {};
        double x = dot(w, unitX_) / z, y = dot(w, unitY_) / z;
        if (!positionIsDelta()) {
            const Vec3f d = (lens.position - position_) * inverseFocus_;
            x += dot(d, unitX_), y += dot(d, unitY_);
        }
        const Vec2f r{float((x - x0_) / dx_), float((y - y0_) / dy_)};
        if (!contains(r)) return {};
        const double pdf = pdfOnAxis_ / (z * z * z);
        if (!checkFinite(Cause::Sensor, pdf)) return {};
        return {positionIsDelta() ? pdf : pdf * positionPdf_ / z, pdf, r};
    }

    bool contains(const Vec2f& raster) const {
        return raster.x >= window_.min.x && raster.x < window_.max.x && raster.y >= window_.min.y && raster.y < window_.max.y;
    }
    /// Uniform over the window: numbers u[0], u[1].
    Vec2f sampleRaster(const Block& u) const {
        return {float(window_.min.x + u[0] * (window_.max.x - window_.min.x)), float(window_.min.y + u[1] * (window_.max.y - window_.min.y))};
    }
    void invertRaster(const Vec2f& raster, Block& u) const {
        u[0] = (double(raster.x) - window_.min.x) / (double(window_.max.x) - window_.min.x);
        u[1] = (double(raster.y) - window_.min.y) / (double(window_.max.y) - window_.min.y);
    }

private:
    FilmSize film_;
    Imath::Box2f window_;
    double windowArea_;
    Vec3f position_, unitX_, unitY_, unitZ_;  // camera axes in world space
    float apertureRadius_, inverseFocus_;
    double positionPdf_;  // 1 / area of the aperture; 1 for a pinhole
    // Point of a raster position on the camera's plane z = 1: x = x0 + dx·raster.x, y = y0 + dy·raster.y.
    double x0_, y0_, dx_, dy_;
    double pdfOnAxis_;  // 1 / area of the window on that plane
};

}  // namespace ulam
