#pragma once
// The audit of one mutation: L0, L1 and L4 on the audit scenes, and L5 with the real samplers.

#include "experiments/verify/work.h"

namespace ulam::verify {

SubjectReport auditMutation(const std::string& mutation, const AuditSettings& settings, References& references);

}  // namespace ulam::verify
