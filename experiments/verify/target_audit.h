#pragma once
// The audits of what chains are distributed as, and of the kernel that sees to it.

#include "experiments/verify/work.h"

namespace ulam::verify {

/// A target (importance): homogeneous of degree 1, positive exactly where light is, and images of both chain samplers
/// with it.
SubjectReport auditTarget(const std::string& target, const AuditSettings& settings, References& references);

/// The Metropolis–Hastings kernel, by enumeration (L3).
SubjectReport auditKernel(const std::string& kernel);

}  // namespace ulam::verify
