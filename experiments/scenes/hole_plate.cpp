#include "experiments/scenes/hole_plate.h"

namespace ulam {
namespace {

Vec3d at(const Imath::V2d& p, double z) {
    return {p.x, p.y, z};
}

/// The face of a cell around its hole: each edge of the hole sees the cell's nearest corner, and where that changes the
/// cell's side fills the gap. `emit` takes the corners counter-clockwise.
template <class Emit>
void ring(const Polygon& hole, const std::array<Imath::V2d, 4>& corners, const Imath::V2d& axis, Emit&& emit) {
    const auto nearestCorner = [&](const Imath::V2d& p) {
        const Imath::V2d d = p - axis;
        return d.y > 0 ? (d.x > 0 ? 0 : 1) : (d.x > 0 ? 3 : 2);
    };
    const size_t n = hole.size();
    const auto cornerOfEdge = [&](size_t i) { return nearestCorner((hole[i] + hole[(i + 1) % n]) / 2); };
    int corner = cornerOfEdge(n - 1);
    for (size_t i = 0; i < n; ++i) {
        for (const int next = cornerOfEdge(i); corner != next; corner = (corner + 1) % 4)
            emit(corners[size_t(corner)], corners[size_t(corner + 1) % 4], hole[i]);
        emit(corners[size_t(corner)], hole[(i + 1) % n], hole[i]);
    }
}

}  // namespace

MeshBuilder HolePlate::mesh() const {
    MeshBuilder mesh;
    const auto face = [&](const Imath::V2d& a, const Imath::V2d& b, const Imath::V2d& c) {
        mesh.triangle(at(a, 0), at(b, 0), at(c, 0));
        if (thickness > 0) mesh.triangle(at(a, -thickness), at(c, -thickness), at(b, -thickness));
    };
    const auto wall = [&](const Imath::V2d& a, const Imath::V2d& b) {
        if (thickness > 0) mesh.quad(at(b, 0), at(a, 0), at(a, -thickness), at(b, -thickness));
    };
    // Lines of the lattice in ascending order: the cells, and a border where they do not fill the plate.
    std::vector<double> lines;
    const double edge = holes * pitch / 2;
    const bool border = halfWidth - edge > 1e-9;
    if (border) lines.push_back(-halfWidth);
    for (int i = 0; i <= holes; ++i) lines.push_back((i - holes / 2.0) * pitch);
    if (border) lines.push_back(halfWidth);

    const int cells = int(lines.size()) - 1, first = border ? 1 : 0;
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const double x0 = lines[size_t(i)], x1 = lines[size_t(i + 1)], y0 = lines[size_t(j)],
                         y1 = lines[size_t(j + 1)];
            const std::array<Imath::V2d, 4> corners{Imath::V2d(x1, y1), {x0, y1}, {x0, y0}, {x1, y0}};
            const int column = holes - 1 - (i - first), row = holes - 1 - (j - first);
            if (column < 0 || column >= holes || row < 0 || row >= holes) {
                face(corners[0], corners[1], corners[2]);
                face(corners[0], corners[2], corners[3]);
                continue;
            }
            const Imath::V2d center = axis(row, column);
            Polygon hole = outline(row, column);
            for (Imath::V2d& p : hole) p += center;
            ring(hole, corners, center, face);
            // Inside a hole the plate's surface faces the axis.
            for (size_t k = 0; k < hole.size(); ++k) wall(hole[(k + 1) % hole.size()], hole[k]);
        }
    for (size_t i = 0; i + 1 < lines.size(); ++i) {
        const double a = lines[i], b = lines[i + 1], w = lines.back();
        wall({a, -w}, {b, -w});
        wall({w, a}, {w, b});
        wall({b, w}, {a, w});
        wall({-w, b}, {-w, a});
    }
    return mesh;
}

}  // namespace ulam
