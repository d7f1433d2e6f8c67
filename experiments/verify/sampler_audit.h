#pragma once
// The audit of one sampler: its images (L5) in every audit scene. A sampler that says itself that a run is biased is
// not judged there.

#include "experiments/verify/work.h"

namespace ulam::verify {

/// Runs of a configured sampler against the reference, as long as the energy interval needs. Adds a comparison, or says
/// why there is none. `place` is for messages and chooses the random numbers.
std::string compareSampler(Json config, const audit::AuditScene& scene, const std::string& place, const AuditSettings& settings,
                           References& references, std::vector<ImageComparison>& comparisons);

SubjectReport auditSampler(const std::string& sampler, const AuditSettings& settings, References& references);

}  // namespace ulam::verify
