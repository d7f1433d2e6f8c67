#pragma once
// Pictures of all directions as pbrt-v4 has them: the square of an unfolded octahedron, on which equal areas are equal
// solid angles (P. Clarberg, "Fast equal-area mapping of the (hemi)sphere using SIMD", 2008). Its middle is +z, its
// corners are −z.

#include "core/base/random.h"
#include "core/scene/environment_map.h"

namespace ulam {

/// A point of [0, 1]² as a direction, and back.
Vec3d octahedralDirection(double u, double v);
Sample2 octahedralPoint(const Vec3d& direction);

/// A picture of environment_map.h of about the same resolution. Texels are means over their cells.
Image latLongFromOctahedral(const Image& square);
/// The other way round, in the world's axes and without the sun.
Image octahedralFromMap(const EnvironmentMap& map, int size);

}  // namespace ulam
