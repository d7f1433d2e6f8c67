#pragma once

#include <fmt/format.h>

#include <cmath>

#include "core/config/json.h"

namespace ulam {

/// A number as JSON, which has no word for what is not finite: that becomes text ("inf", "nan").
inline Json numberOrText(double x) { return std::isfinite(x) ? Json(x) : Json(fmt::format("{}", x)); }

}  // namespace ulam
