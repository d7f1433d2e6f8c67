#pragma once
// The plate of grid_of_holes: a square slab around the origin, front face at z = 0, back face at z = −thickness, with
// n × n straight polygonal holes.

#include "experiments/scenes/apertures.h"
#include "experiments/scenes/mesh_builder.h"

namespace ulam {

struct HolePlate {
    int holes;                      ///< a side
    double pitch;                   ///< between axes; the grid is in the plate's middle
    double thickness;               ///< 0: a sheet whose normal is +z
    double halfWidth;               ///< of the plate
    std::vector<Polygon> outlines;  ///< by row and column, around the axis of each

    /// The axis of a hole. Row 0 is the one of largest y, column 0 the one of largest x: the upper left one in an image
    /// of ReceiverView.
    Imath::V2d axis(int row, int column) const {
        const double half = (holes - 1) / 2.0;
        return {(half - column) * pitch, (half - row) * pitch};
    }
    const Polygon& outline(int row, int column) const { return outlines[size_t(row * holes + column)]; }

    MeshBuilder mesh() const;
};

}  // namespace ulam
