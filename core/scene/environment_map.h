#pragma once
// A picture of the radiance from all around, and directions drawn by its luminance.
//
// Mitsuba 3's parametrisation: a direction (x, y, z) of the map's own frame has u = atan2(x, −z) / 2π and
// v = acos(y) / π. Column i of the picture lies at u = (i + ½) / width and wraps around, row j at v = j / (height − 1):
// the first and last row are the poles. Between them the radiance is bilinear in (u, v).

#include "core/base/discrete.h"
#include "core/image/image.h"

namespace ulam {

class EnvironmentMap {
public:
    /// `axes`: the map's x, y and z in world space, orthonormal. At least two rows.
    EnvironmentMap(Image image, double scale, const std::array<Vec3f, 3>& axes);

    /// From a unit direction of the world.
    Spectrum radiance(const Vec3f& w) const;
    /// ∫ luminance dω; 0: no light.
    double totalLuminance() const { return rows_.total(); }

    /// Chooses a cell between four texels by its ∫ luminance dω, then a direction in it, uniform per solid angle.
    Vec3f sample(double u, double v) const;
    double pdf(const Vec3f& w) const;
    Sample2 invert(const Vec3f& w) const;

private:
    struct Place {
        int row, column;   ///< of the cell
        double down, along;  ///< inside the cell, in [0, 1]: fractions of the rows' distance, of the columns'
        double cosTheta;
    };
    Place place(const Vec3f& w) const;
    double cosineOfRow(int row) const { return std::cos(kPi * row / (image_.height - 1)); }
    double cellSolidAngle(int row) const;
    const Rgb& texel(int row, int column) const { return image_.at(column % image_.width, row); }

    Image image_;
    std::array<Vec3f, 3> axes_;
    DiscreteDistribution rows_;
    std::vector<DiscreteDistribution> columns_;  // one a row
};

}  // namespace ulam
