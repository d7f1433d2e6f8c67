#pragma once
// The path validator. It distrusts everything that a path and its factors say and recomputes it from the scene.

#include <optional>
#include <string>

#include "core/path/factors.h"

namespace ulam {

/// How far a factor may be from its definition, relative, beside what the float geometry explains
/// (reference_factors.h).
inline constexpr double kFactorTolerance = 1e-5;

/// What is wrong with a path, where, with numbers; nothing if all of this holds:
/// at most limits.maxDepth edges; x_0 a point that shines, x_k the lens, surfaces between; every vertex lies on its
/// primitive and has its normals; neighbours see each other; lobes exist at their material, delta lobes obey their law;
/// light leaves x_0 along the first edge and the last one is in the sensor's window; edges, f̂, densities and f agree
/// with their definitions.
std::optional<std::string> validate(Tracing& tracing, const PathLimits& limits, const Path& path,
                                    const PathFactors& factors);

}  // namespace ulam
