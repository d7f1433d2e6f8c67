#pragma once
// Subdivision surfaces of triangles after C. Loop, "Smooth subdivision surfaces based on triangles", 1987, with the
// weights that pbrt has: limit positions and normals of the vertices after some levels.

#include <array>
#include <stdexcept>
#include <vector>

#include "core/base/vector.h"

namespace ulam::pbrt {

struct SubdivisionMesh {
    std::vector<Vec3d> positions, normals;
    std::vector<std::array<int, 3>> triangles;
};

/// The message says why a mesh has no limit surface.
struct NoSurface : std::runtime_error {
    using runtime_error::runtime_error;
};

/// Normals point where pbrt's do: to the side from which the given triangles are clockwise, unlike those of meshes.
SubdivisionMesh subdivide(std::vector<Vec3d> positions, std::vector<std::array<int, 3>> triangles, int levels);

}  // namespace ulam::pbrt
