#pragma once
// sunsky: a clear sky and the sun (Mitsuba 3 `sunsky`).

#include "core/config/parameters.h"
#include "core/scene/emitter.h"
#include "core/scene/loading/context.h"

namespace ulam {

std::vector<ParameterInfo> sunskyParameters();
Emitter readSunsky(const JsonNode& node, LoadContext& context);

}  // namespace ulam
