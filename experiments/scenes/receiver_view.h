#pragma once
// A pinhole close to the plane z = 0 that looks along +z at a receiver in the plane z = d, so that the image holds just
// the unit square around the origin of that plane: pixel to receiver point is affine.

#include "core/config/json.h"
#include "core/scene/sensors/perspective.h"

namespace ulam {

struct ReceiverView {
    double distance;      ///< of the receiver's plane
    double pinholeX = 0;  ///< the pinhole is at (pinholeX, 0, kPinholeZ)

    static constexpr double kPinholeZ = 0.005;

    /// The sensor's dictionary: square film with a box filter.
    Json sensor() const;

    /// The part of the receiver's plane that a pixel sees.
    struct Square {
        double x0, x1, y0, y1;
    };
    Square pixel(const FilmSize& film, int x, int y) const;
    Square image(const FilmSize& film) const;
};

}  // namespace ulam
