#pragma once
// How large pictures, maps and chains may be, so that a page holds those of all cells.

#include <vector>

#include "experiments/report/cell_plan.h"

namespace ulam {

struct PageSizes {
    bool exact = true;                           ///< pictures are RGB9E5, not JPEG
    int quality = 0;                             ///< of JPEG, 0 … 100
    int pictures = 1, maps = 1, techniques = 1;  ///< edges of the blocks of pixels that became one
    double chainBytes = 0;                       ///< of base64, for the chains of one cell
};

/// Together at most `room` bytes of base64, of which as much is used as JPEG has a use for. Reads the references and
/// the median replicates where the exact pictures are too large.
PageSizes choosePageSizes(const std::vector<CellPlan>& plans, double room);

constexpr double base64Size(double bytes) {
    return bytes * 4 / 3;
}

}  // namespace ulam
