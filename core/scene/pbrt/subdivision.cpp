#include "core/scene/pbrt/subdivision.h"

#include <cstdint>
#include <unordered_map>

namespace ulam::pbrt {
namespace {

uint64_t key(int a, int b) {
    return uint64_t(uint32_t(a)) << 32 | uint32_t(b);
}

/// Triangles by their directed edges: where (a, b, c) is one, the corner after (a, b) is c.
class Connectivity {
public:
    Connectivity(const std::vector<std::array<int, 3>>& triangles, size_t vertices)
        : first_(vertices, -1), corners_(vertices, 0) {
        next_.reserve(3 * triangles.size());
        for (const auto& t : triangles)
            for (size_t i = 0; i < 3; ++i) {
                const int a = t[i], b = t[(i + 1) % 3];
                if (a == b) throw NoSurface("a triangle has a vertex twice");
                if (!next_.emplace(key(a, b), t[(i + 2) % 3]).second)
                    throw NoSurface(
                        "more than two triangles meet at an edge, or neighbours turn in opposite directions");
                first_[size_t(a)] = b;
                ++corners_[size_t(a)];
            }
    }

    /// -1: there is no such triangle.
    int after(int a, int b) const {
        const auto found = next_.find(key(a, b));
        return found == next_.end() ? -1 : found->second;
    }

    struct Ring {
        std::vector<int> vertices;  ///< counter-clockwise; at a border from one border edge to the other
        bool isBorder = false;
    };
    /// Neighbours of a vertex; none for one without triangles.
    Ring ring(int vertex) const {
        Ring result;
        int start = first_[size_t(vertex)];
        if (start < 0) return result;
        // Clockwise as far as it goes: the triangle before (vertex, start, …) is the one with the edge (start, vertex).
        for (int back = after(start, vertex), steps = 0; back != first_[size_t(vertex)]; back = after(start, vertex)) {
            if (back < 0) {
                result.isBorder = true;
                break;
            }
            start = back;
            if (++steps > corners_[size_t(vertex)]) throw NoSurface("surfaces touch at a single vertex");
        }
        result.vertices.push_back(start);
        int triangles = 0;
        for (int at = after(vertex, start); at >= 0; at = after(vertex, at)) {
            if (++triangles > corners_[size_t(vertex)]) break;
            if (at == start) break;
            result.vertices.push_back(at);
        }
        if (int(result.vertices.size()) - (result.isBorder ? 1 : 0) != corners_[size_t(vertex)])
            throw NoSurface("surfaces touch at a single vertex");
        return result;
    }

private:
    std::unordered_map<uint64_t, int> next_;
    std::vector<int> first_, corners_;
};

/// Weight of each neighbour.
double beta(size_t valence) {
    return valence == 3 ? 3.0 / 16 : 3 / (8 * double(valence));
}

/// A vertex drawn towards its neighbours: at a border only to those along it.
Vec3d relaxed(const std::vector<Vec3d>& positions, int vertex, const Connectivity::Ring& ring, double inner,
              double border) {
    const auto& r = ring.vertices;
    const Vec3d& p = positions[size_t(vertex)];
    if (ring.isBorder)
        return p * (1 - 2 * border) + (positions[size_t(r.front())] + positions[size_t(r.back())]) * border;
    Vec3d sum(0.0);
    for (const int neighbour : r) sum += positions[size_t(neighbour)];
    return p * (1 - double(r.size()) * inner) + sum * inner;
}

Vec3d normalAt(const std::vector<Vec3d>& positions, int vertex, const Connectivity::Ring& ring) {
    const size_t n = ring.vertices.size();
    const auto at = [&](size_t i) -> const Vec3d& { return positions[size_t(ring.vertices[i])]; };
    const Vec3d& p = positions[size_t(vertex)];
    Vec3d s(0.0), t(0.0);
    if (!ring.isBorder) {
        for (size_t i = 0; i < n; ++i) {
            const double angle = 2 * kPi * double(i) / double(n);
            s += at(i) * std::cos(angle);
            t -= at(i) * std::sin(angle);
        }
    } else {
        s = at(n - 1) - at(0);
        if (n == 2) {
            t = at(0) + at(1) - p * 2;
        } else if (n == 3) {
            t = at(1) - p;
        } else if (n == 4) {
            t = at(1) * 2 + at(2) * 2 - at(0) - at(3) - p * 2;
        } else {
            const double angle = kPi / double(n - 1);
            t = (at(0) + at(n - 1)) * -std::sin(angle);
            for (size_t i = 1; i + 1 < n; ++i) t += at(i) * ((2 - 2 * std::cos(angle)) * std::sin(double(i) * angle));
        }
    }
    return s.cross(t).normalized();
}

SubdivisionMesh refined(const SubdivisionMesh& mesh) {
    const Connectivity connectivity(mesh.triangles, mesh.positions.size());
    SubdivisionMesh fine;
    for (int v = 0; v < int(mesh.positions.size()); ++v) {
        const auto ring = connectivity.ring(v);
        fine.positions.push_back(ring.vertices.empty()
                                     ? mesh.positions[size_t(v)]
                                     : relaxed(mesh.positions, v, ring, beta(ring.vertices.size()), 1.0 / 8));
    }
    std::unordered_map<uint64_t, int> middles;
    const auto middle = [&](int a, int b) {
        const auto [known, isNew] =
            middles.try_emplace(key(std::min(a, b), std::max(a, b)), int(fine.positions.size()));
        if (!isNew) return known->second;
        const auto at = [&](int i) -> const Vec3d& { return mesh.positions[size_t(i)]; };
        const int c = connectivity.after(a, b), d = connectivity.after(b, a);
        fine.positions.push_back(c < 0 || d < 0 ? (at(a) + at(b)) * 0.5
                                                : (at(a) + at(b)) * (3.0 / 8) + (at(c) + at(d)) * (1.0 / 8));
        return known->second;
    };
    fine.triangles.reserve(4 * mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    return fine;
}

}  // namespace

SubdivisionMesh subdivide(std::vector<Vec3d> positions, std::vector<std::array<int, 3>> triangles, int levels) {
    SubdivisionMesh mesh{std::move(positions), {}, std::move(triangles)};
    for (int level = 0; level < levels; ++level) mesh = refined(mesh);
    const Connectivity connectivity(mesh.triangles, mesh.positions.size());
    std::vector<Vec3d> limit = mesh.positions;
    mesh.normals.assign(mesh.positions.size(), Vec3d(0.0));
    for (int v = 0; v < int(limit.size()); ++v) {
        const auto ring = connectivity.ring(v);
        if (ring.vertices.empty()) continue;
        const double n = double(ring.vertices.size());
        limit[size_t(v)] = relaxed(mesh.positions, v, ring, 1 / (n + 3 / (8 * beta(ring.vertices.size()))), 1.0 / 5);
    }
    for (int v = 0; v < int(limit.size()); ++v)
        if (const auto ring = connectivity.ring(v); !ring.vertices.empty())
            mesh.normals[size_t(v)] = normalAt(limit, v, ring);
    mesh.positions = std::move(limit);
    return mesh;
}

}  // namespace ulam::pbrt
