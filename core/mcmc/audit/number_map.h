#pragma once
// Densities of paths from nothing but the map that makes them out of random numbers: the map is repeated with single
// numbers displaced.
//
// A number that moves the path carries density. Together these numbers have a Jacobian, found by central differences,
// from numbers to the coordinates of the vertices that move: on the tangent plane, or of the direction where a vertex
// is at infinity. Vertices that a delta lobe places are not free; they contribute the lobe's δ_σ (lobe.h). A number
// that does not move the path is a choice and carries probability: the length of the interval in which it leaves the
// path as it is, found by bisection (choices made from one number each, by intervals).

#include <functional>

#include "core/path/factors.h"

namespace ulam::audit {

/// Makes a path from random numbers; false where there is none. Numbers beyond those given are the stream's own.
using NumberMap = std::function<bool(std::span<const Block> numbers, Path& path, PathFactors& factors)>;

/// What displacing numbers says about one path that was made from them.
struct Branch {
    enum class Outcome : uint8_t {
        Resolved,
        Noisy,      ///< two step widths disagree, or a displaced path is not comparable (another shape, no path at all)
        NotSquare,  ///< not as many numbers as coordinates
    };
    Outcome outcome = Outcome::Noisy;
    double logDensity = 0;  ///< of this branch: of the path, made by these choices
    bool only = false;      ///< no other choices were found that can make the same path
    std::string moved;      ///< one mark a vertex: '*' made freely, '+' placed by a delta lobe, '.' kept
};

/// `path` and `factors` are what the map makes of `numbers`; vertices that it has from `origin` (empty: none) count as
/// kept. `alternatives` draws other numbers to find other branches.
Branch findBranch(const NumberMap& map, std::span<const Block> numbers, const Scene& scene, const Path& origin,
                  const Path& path, const PathFactors& factors, Random alternatives);

}  // namespace ulam::audit
