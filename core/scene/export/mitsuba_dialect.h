#pragma once
// What differs between the versions of Mitsuba that scenes are written for.

#include "core/config/parameters.h"
#include "core/scene/export/export_folder.h"
#include "core/scene/export/nearest.h"

namespace ulam {

struct MitsubaDialect {
    const char* version;
    ExportFormat format;
    std::optional<Nearest> (*nearest)(const JsonNode& plugin);
    /// A parameter's name.
    std::string (*spelled)(const std::string& name);
    /// A plugin in this version's parameters, without what is nested; `lost` gets what they cannot say.
    Json (*reworded)(const JsonNode& plugin, std::vector<std::string>& lost);
    std::vector<ParameterInfo> parameters;  ///< that only this version has
    bool choosesIntegrator;                 ///< the scene must name one
};

const MitsubaDialect& mitsuba3();
const MitsubaDialect& mitsuba06();

}  // namespace ulam
