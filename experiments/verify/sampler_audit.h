#pragma once
// The audit of one sampler: its images (L5) in every audit scene. A sampler that says itself that a run is biased is
// not judged there.

#include "experiments/verify/work.h"

namespace ulam::verify {

SubjectReport auditSampler(const std::string& sampler, const AuditSettings& settings, References& references);

}  // namespace ulam::verify
