#pragma once
// The values that one key of a sweep takes.

#include <vector>

#include "core/config/json.h"

namespace ulam {

inline constexpr std::int64_t kMostSweepValues = 1000;  ///< of a range

/// A list, or a range: {"linear": [first, last], "steps": n} has equal differences, {"log": [first, last], "steps": n}
/// equal ratios, both with exact ends; with "draws": n in place of steps the values are random, uniform on that scale,
/// the k-th a function of `stream` and k alone. Where both ends are whole numbers all values are, and may repeat. Fails
/// with InvalidConfig.
std::vector<Json> sweepValues(const JsonNode& node, std::uint64_t stream);

}  // namespace ulam
