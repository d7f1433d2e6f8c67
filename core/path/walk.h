#pragma once
// Random walks from either end of a path: the subpaths of bidirectional path tracing (Veach 1997, §10.1).

#include "core/path/scattering.h"
#include "core/path/tracing.h"

namespace ulam {

/// How long paths get, for all samplers alike.
struct PathLimits {
    int maxDepth = 8;  ///< edges of the longest path; 1: emitters seen directly
    int rrDepth = 5;   ///< walks end by Russian roulette from this vertex of theirs on

    template <class V>
    void describe(V& v) {
        v("max_depth", maxDepth, {.help = "longest path in edges; 1 = emitters seen directly, 2 = direct light", .min = 1, .max = kMaxDepth});
        v("rr_depth", rrDepth, {.help = "vertex of a walk from which Russian roulette may end it", .min = 1, .max = 1e6});
    }

    /// Probability that a walk goes on at its vertex `index`: a function of the vertex and its index from the walk's own
    /// end only, so that densities stay local.
    double continuation(int index, double albedo) const { return index < rrDepth ? 1 : std::min(0.95, albedo); }
    bool hasRoulette() const { return rrDepth < maxDepth; }
};

/// A walk's vertices, its own end first, and beside each vertex what the walk knows about it.
struct Subpath {
    int size = 0;
    double direct = 0;  ///< of a light walk: density of vertex 0 by next-event estimation from vertex 1
    std::array<Vertex, kMaxVertices + 1> vertex;
    std::array<Edge, kMaxVertices + 1> back;  ///< from the vertex to the one before it; from vertex 1 on
    /// Π f-factors / densities up to the arrival at the vertex; L_e and W_e included from vertex 1 on.
    std::array<Spectrum, kMaxVertices + 1> throughput;
    /// Area density of the vertex as this walk makes it, Russian roulette included.
    std::array<double, kMaxVertices + 1> forward;
    /// Area density of the vertex as a walk from the other end makes it, having come through the next two vertices of
    /// this walk; without Russian roulette, whose index counts from the other end.
    std::array<double, kMaxVertices + 1> backward;
    std::array<double, kMaxVertices + 1> albedo;  ///< 1 where no walk plays Russian roulette

    Subpath() {}
};

/// Light walk of at most `vertices` vertices.
void walkFromLight(Tracing& tracing, const PathLimits& limits, int vertices, Numbers& numbers, Subpath& path);

/// Camera walk of at most `vertices` vertices through a raster position. It may end on the environment.
void walkFromCamera(Tracing& tracing, const PathLimits& limits, int vertices, const Vec2f& raster, Numbers& numbers, Subpath& path);

/// One more vertex for a walk whose last vertex is on a surface; false where it ends. The building block of both walks.
bool extendWalk(Tracing& tracing, const PathLimits& limits, From from, const Block& numbers, Subpath& path);

}  // namespace ulam
