#pragma once
// What tells two JSON values apart.

#include <string>
#include <string_view>

#include "core/config/json.h"

namespace ulam {

/// Of two values that differ the first difference: "/sampler/chains is 500, 1000 in the checkpoint". `place` is where
/// `stored` stands.
std::string firstDifference(const Json& stored, const Json& wanted, std::string_view place);

}  // namespace ulam
