#pragma once
// Light of uniform radiance that reaches a parallel plane through polygonal holes, exactly: Lambert's formula (Lambert
// 1760, Photometria; Nusselt's analog) on the part of a hole that a point of the plane sees the light through.

#include <functional>
#include <vector>

#include "core/base/vector.h"

namespace ulam {

/// Convex, corners counter-clockwise.
using Polygon = std::vector<Imath::V2d>;

/// Regular, with a corner in the direction `phase` (radians).
Polygon regularPolygon(const Imath::V2d& center, double area, int sides, double phase);

/// What two convex polygons have in common (Sutherland and Hodgman 1974).
Polygon intersection(Polygon subject, const Polygon& window);

/// Irradiance of a point at the origin from a polygon of radiance 1 in a parallel plane at this distance.
double lambertIrradiance(const Polygon& polygon, double distance);

/// A straight hole through a plate of this thickness, lit from behind by radiance 1.
struct Hole {
    Polygon outline;
    double thickness;

    /// At a point of the plane at `distance` in front of the plate.
    double irradiance(const Imath::V2d& point, double distance) const;
    /// Points of that plane farther than this from the hole's axis (the origin) get no light.
    double reach(double distance) const;
};

/// ∫∫ f over a rectangle, to an absolute error of about `tolerance`, for a continuous f with kinks: tensor Gauss rules
/// of 2 and 3 points are compared, and quarters taken where they differ. Rectangles are quartered to `largestCell`,
/// which must be small against f's features: what only touches a cell's corner, beyond the rules' nodes, goes unseen.
double integrate(const std::function<double(double, double)>& f, double x0, double x1, double y0, double y1,
                 double tolerance, double largestCell);

}  // namespace ulam
