#pragma once
// What Mitsuba 0.4 to 0.6 name or mean differently from Mitsuba 3.

#include "core/config/json.h"

namespace ulam {

/// The first two numbers of a scene's version.
struct MitsubaVersion {
    int major = 3, minor = 0;
    bool camelCase() const { return major < 2; }
};

/// "toWorld" becomes "to_world", "intIOR" "int_ior".
std::string underscored(std::string_view camelCase);

/// One plugin's dictionary, names of parameters already underscored. `tag`: its element ("bsdf").
void upgradePlugin(Json& plugin, std::string_view tag, const MitsubaVersion& version);

}  // namespace ulam
