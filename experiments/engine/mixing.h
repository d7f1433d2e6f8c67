#pragma once
// How well the chains of one run mixed, for its result.json.

#include "core/config/json.h"
#include "core/render/statistics.h"

namespace ulam {

/// By scalar: nested and split R-hat, effective sample size and its rate, integrated autocorrelation time in mutations
/// of a chain and whether that is a bound only (docs/statistics.md). Null where the traces are too short.
Json mixing(const std::vector<ChainTrace>& traces, double seconds, int threads);

}  // namespace ulam
