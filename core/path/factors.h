#pragma once
// The factors of f and of the densities, edge by edge and vertex by vertex, beside a path. Each depends on at most three
// neighbouring vertices and on no index, so that a mutation re-evaluates only the range it changed, also when the path
// gets longer or shorter.

#include "core/path/densities.h"

namespace ulam {

struct PathFactors {
    /// edge[i]: x_i – x_{i+1}
    std::array<Edge, kMaxVertices> edge;
    /// at[0]: L_e and the density of its direction; at[k]: W_e likewise; between: f̂_s
    std::array<Scattering, kMaxVertices> at;
    int size = 0;  ///< vertices

    PathFactors() {}
    PathFactors(const PathFactors& other) { *this = other; }
    PathFactors& operator=(const PathFactors& other) {
        copy(other, 0, other.size, 0);
        size = other.size;
        return *this;
    }

    /// Takes entries [first, last) of `other` to `to`…
    void copy(const PathFactors& other, int first, int last, int to) {
        std::copy(other.edge.begin() + first, other.edge.begin() + last, edge.begin() + to);
        std::copy(other.at.begin() + first, other.at.begin() + last, at.begin() + to);
    }

    template <class Archive>
    void archive(Archive& a) {
        a(size);
        for (int i = 0; i < size; ++i) a(at[size_t(i)]);
        for (int i = 0; i + 1 < size; ++i) a(edge[size_t(i)]);
    }

    /// Area density of x_i when a walk from the light arrives from x_{i−1}; without Russian roulette. i ≥ 1.
    double fromLight(int i) const { return edge[i - 1].toAreaB(at[i - 1].pdfToCamera); }
    /// Area density of x_i when a walk from the camera arrives from x_{i+1}; without Russian roulette. i < k.
    double fromCamera(int i) const { return edge[i].toAreaA(at[i + 1].pdfToLight); }

    /// f(x) = L_e · Π f̂_s · Π G · W_e; visibility is the path's own affair.
    Spectrum contribution() const;
};

/// Recomputes the edges between x_first and x_last and the scattering at x_first … x_last. False as soon as a factor is
/// zero (the rest then is undefined). factors.size must be path.size().
bool evaluate(const Scene& scene, const Path& path, int first, int last, PathFactors& factors);

/// Everything of a whole path.
inline bool evaluate(const Scene& scene, const Path& path, PathFactors& factors) {
    factors.size = path.size();
    return evaluate(scene, path, 0, path.length(), factors);
}

/// Densities of all techniques, Russian roulette included.
PathDensities densities(const Scene& scene, const PathLimits& limits, const Path& path, const PathFactors& factors);

}  // namespace ulam
