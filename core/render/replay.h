#pragma once
// Samples and steps of chains made again, in words and numbers for people: paths vertex by vertex, with densities and
// contribution. What is refused for not being finite is named where it arises.

#include "core/config/json.h"
#include "core/mcmc/kernel.h"
#include "core/path/bidirectional.h"

namespace ulam {

/// A path: vertices and edges with their factors of f, densities from either end, log p_{s,t} and w_{s,t} of every
/// technique, and f.
Json describePath(const Scene& scene, const PathLimits& limits, const Path& path);

/// A sample of bidirectional path tracing: its walks, its contributions, and the paths of those that are not finite.
Json describeSample(const Scene& scene, const BidirectionalOptions& options, const Vec2f& raster, Numbers& numbers);

/// A step of a chain.
Json describeStep(const Scene& scene, const BidirectionalOptions& options, const MutationMix& mix, const Chain& before,
                  const Proposal& proposal, const StepInfo& info);

}  // namespace ulam
