#pragma once
// A picture of the radiance from all around, perhaps a sun in it, and directions drawn by their luminance.
//
// Mitsuba 3's parametrisation: a direction (x, y, z) of the map's own frame has u = atan2(x, −z) / 2π and
// v = acos(y) / π. Column i of the picture lies at u = (i + ½) / width and wraps around, row j at v = j / (height − 1):
// the first and last row are the poles. Between them the radiance is bilinear in (u, v).
//
// A picture of the upper hemisphere ends at the horizon, with nothing below. There the skies are steep: its rows crowd
// towards it, row j at the elevation (1 − j / (height − 1))² π/2, and the radiance is bilinear in u and j.

#include <optional>

#include "core/base/discrete.h"
#include "core/image/image.h"
#include "core/scene/sun_disc.h"

namespace ulam {

class EnvironmentMap {
public:
    enum class Extent { Sphere, UpperHemisphere };

    /// `axes`: the map's x, y and z in world space, orthonormal. At least two rows.
    EnvironmentMap(Image image, double scale, const std::array<Vec3f, 3>& axes, Extent extent = Extent::Sphere,
                   const std::optional<SunDisc>& sun = {});

    /// From a unit direction of the world.
    Spectrum radiance(const Vec3f& w) const;
    /// The same without the sun.
    Spectrum pictureRadiance(const Vec3f& w) const { return pictureRadiance(place(w)); }
    /// ∫ luminance dω; 0: no light.
    double totalLuminance() const { return rows_.total() + sunLuminance_; }
    const std::optional<SunDisc>& sun() const { return sun_; }
    /// That the picture and its distributions take.
    size_t bytes() const { return image_.pixels.size() * (sizeof(Rgb) + sizeof(double)); }

    /// Chooses the sun or the picture by ∫ luminance dω. Of the picture it chooses a cell between four texels likewise,
    /// then a direction in it, uniform per solid angle.
    Vec3f sample(double u, double v) const;
    double pdf(const Vec3f& w) const;
    /// Where the sun stands before the picture, `choice` says which of them w comes from: uniform, and only read there.
    Sample2 invert(const Vec3f& w, double choice) const;

    /// The angle of a row of a hemisphere's picture to the zenith.
    static double hemisphereAngle(double row, int height) {
        const double t = row / (height - 1);
        return kPi / 2 * t * (2 - t);
    }

private:
    struct Place {
        int row, column;   ///< of the cell
        double down, along;  ///< inside the cell, in [0, 1]: fractions of the rows' distance, of the columns'
        double cosTheta;
        bool outside;  ///< below the horizon of a hemisphere
    };
    Place place(const Vec3f& w) const;
    Spectrum pictureRadiance(const Place& p) const;
    /// The picture's and the sun's parts of the density.
    double picturePdf(const Place& p) const;
    double sunPdf(const Vec3f& w) const;
    double cosineOfRow(int row) const {
        if (extent_ == Extent::UpperHemisphere) return std::cos(hemisphereAngle(row, image_.height));
        return std::cos(kPi * row / (image_.height - 1));
    }
    double cellSolidAngle(int row) const;
    const Rgb& texel(int row, int column) const { return image_.at(column % image_.width, row); }

    Image image_;
    std::array<Vec3f, 3> axes_;
    Extent extent_;
    DiscreteDistribution rows_;
    std::vector<DiscreteDistribution> columns_;  // one a row
    std::optional<SunDisc> sun_;
    double sunLuminance_ = 0;  // ∫ dω
    double sunShare_ = 0;      // of the samples
};

}  // namespace ulam
