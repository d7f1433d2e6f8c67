#pragma once
// The audit as one HTML file with pictures; it asks nobody for anything.

#include "experiments/verify/report.h"

namespace ulam::verify {

/// A table of the levels of each subject; proposals against their density (L2); uniformity and place of the tile tests'
/// p-values (L5, L6).
std::string toHtml(const Report& report);

}  // namespace ulam::verify
