#pragma once
// The densities with which bidirectional techniques make one and the same path, and their combination (multiple
// importance sampling). log p_{s,t}(x) = Σ_{i<s} log fromLight[i] + Σ_{i≥s} log fromCamera[i].
//
// The per-vertex entries are plain area densities: each is one geometric conversion away from a directional density and
// far from overflow. Only sums over a whole path are logs.

#include "core/path/walk.h"

namespace ulam {

enum class Heuristic : uint8_t { Balance, Power };

/// Which techniques a sampler uses.
struct TechniqueSet {
    bool hitLight = true;       ///< s = 0
    bool nextEvent = true;      ///< s = 1, t ≥ 2
    bool connect = true;        ///< s ≥ 2, t ≥ 2
    bool lightImage = true;     ///< t = 1
    bool walkFromLight() const { return connect || lightImage; }
    bool walkFromCamera() const { return hitLight || nextEvent || connect; }  ///< beyond the lens
    bool contains(int s, int t) const {
        if (t == 1) return lightImage && s >= 1;
        return s == 0 ? hitLight : s == 1 ? nextEvent : connect;
    }
};

struct PathDensities {
    int size = 0;  ///< vertices, k + 1
    std::array<double, kMaxVertices> fromLight;   ///< of x_i, made from the light, Russian roulette included
    std::array<double, kMaxVertices> fromCamera;  ///< of x_i, made from the camera
    std::array<bool, kMaxVertices> delta;         ///< x_i scatters by a delta lobe
    double directLight = 0;                       ///< of x_0 by next-event estimation: replaces fromLight[0] for s = 1
    double directCamera = 1;                      ///< of x_k joined to the lens: replaces fromCamera[k] for t = 1
    bool lightHittable = false;                   ///< s = 0 possible

    PathDensities() {}

    /// Can (s, size − s) make this path at all? t = 0 needs a lens that can be hit; a pinhole cannot.
    bool possible(int s) const {
        const int t = size - s;
        if (t < 1) return false;
        if (s == 0) return lightHittable;
        return !delta[s - 1] && !delta[s];
    }

    /// log p_{s, size−s}; −∞ where impossible.
    double log(int s) const;

    /// Weight of technique s among those of `set`; the density of s must be positive.
    double weight(int s, const TechniqueSet& set, Heuristic heuristic) const;

private:
    double direct(int s) const {
        double c = 1;
        if (s == 1) c *= directLight / fromLight[0];
        if (size - s == 1) c *= directCamera / fromCamera[size - 1];
        return c;
    }
};

/// The path that joins the first s vertices of a light walk to the first t of a camera walk, its densities, and the
/// contribution of that technique, unweighted.
struct Connection {
    PathDensities densities;
    Spectrum contribution{0.0};  ///< f / p_{s,t}
    Vec2f raster;                ///< t = 1 only
};

/// Joins the walks by the edge y_{s−1}–z_{t−1}, s ≥ 1, t ≥ 1: false when nothing gets through. For s = 1 the light walk's
/// vertex 0 must be a next-event sample (its `forward` then is directLight), for t = 1 the camera walk's vertex 0 the lens.
bool connect(Tracing& tracing, const PathLimits& limits, const Subpath& light, int s, const Subpath& camera, int t, Connection& out);

/// s = 0: the camera walk's vertex t−1 shines.
bool hitLight(Tracing& tracing, const PathLimits& limits, const Subpath& camera, int t, Connection& out);

/// Next-event estimation from `from`: x_0 as a one-vertex light subpath.
void sampleDirectLight(const Scene& scene, const Vertex& from, const Block& numbers, Subpath& light);

}  // namespace ulam
