#pragma once
// Named places that a path can pass: the holes of a plate, a door's gap, a keyhole. They label paths, so that trapping
// of Markov chains can be seen (which hole, how often do chains change it).

#include "core/scene/shape.h"

#include <string>
#include <vector>

namespace ulam {

/// A rectangle in space, divided into rows × columns cells; cell (0, 0) is at `corner`, columns run along `across`, rows
/// along `down` (both reach from side to side). Cells are numbered row by row.
struct Features {
    Vec3f corner{0, 0, 0}, across{0, 0, 0}, down{0, 0, 0};
    int rows = 0, columns = 0;
    std::vector<std::string> names;  ///< rows × columns of them

    bool empty() const { return names.empty(); }

    /// The cell a segment passes through, or kNone.
    uint32_t crossed(const Vec3f& a, const Vec3f& b) const {
        const Vec3f n = cross(across, down);
        const float da = dot(n, a - corner), db = dot(n, b - corner);
        if ((da > 0) == (db > 0)) return kNone;
        const Vec3f p = a + (b - a) * (da / (da - db)) - corner;
        const float x = dot(p, across) / length2(across), y = dot(p, down) / length2(down);
        if (x < 0 || x >= 1 || y < 0 || y >= 1) return kNone;
        return uint32_t(int(y * float(rows)) * columns + int(x * float(columns)));
    }
};

}  // namespace ulam
