#pragma once
// Sensor, film and reconstruction filter plugins.

#include "core/image/filter.h"
#include "core/scene/loading/context.h"
#include "core/scene/plugins.h"
#include "core/scene/sensors/perspective.h"

namespace ulam {

std::vector<PluginInfo> sensorPlugins();
std::vector<PluginInfo> filmPlugins();
std::vector<PluginInfo> filterPlugins();
/// Filters of Mitsuba in whose place a gaussian is taken, with a warning.
const std::vector<std::string>& replacedFilters();

/// Integrators and samplers stand in Mitsuba's scenes, but not in Ulam's: they are only noted. Returns whether it is
/// one.
bool noteIfUnused(const JsonNode& node, LoadContext& context);

struct FilmSettings {
    FilmSize size;
    ReconstructionFilter filter;
};
/// The film nested in a sensor (Mitsuba 3's default where there is none), with what `replacement` (null: nothing) says
/// instead.
FilmSettings readFilm(const JsonNode& sensor, const JsonNode& replacement, LoadContext& context);

Perspective readSensor(const JsonNode& node, const FilmSettings& film, LoadContext& context);

}  // namespace ulam
