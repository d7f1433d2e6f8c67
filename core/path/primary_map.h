#pragma once
// The map from primary numbers to the path of one technique, and its inverse (Otsu et al. 2017, Pantaleoni 2017,
// Bitterli et al. 2017).

#include "core/path/walk.h"

namespace ulam {

/// The path that technique (s, t) makes from u: walks of exactly s and t vertices, joined by a visible edge. u is
/// extended from `random` as far as it is used. False where a walk ends early or nothing gets through.
bool makePath(Tracing& tracing, const PathLimits& limits, Technique technique, PrimaryVector& u, Random& random, Path& path);

/// Numbers that make `path` by the technique; those that the path does not determine (a lobe's choice, Russian roulette)
/// come from `random`. False where there are none.
bool invertPath(const Tracing& tracing, const PathLimits& limits, Technique technique, const Path& path, Random& random, PrimaryVector& u);

}  // namespace ulam
