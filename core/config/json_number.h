#pragma once

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "core/config/json.h"

namespace ulam {

/// A number as JSON, which has no word for what is not finite: that becomes text ("inf", "nan").
inline Json numberOrText(double x) { return std::isfinite(x) ? Json(x) : Json(fmt::format("{}", x)); }
/// null for what is not finite: an infinite psnr, a variation of nothing.
inline Json numberOrNull(double x) { return std::isfinite(x) ? Json(x) : Json(); }
/// [low, high]; null where there is none.
template <class Interval>
Json intervalOrNull(const std::optional<Interval>& i) {
    return i ? Json::array({numberOrNull(i->low), numberOrNull(i->high)}) : Json();
}

}  // namespace ulam
