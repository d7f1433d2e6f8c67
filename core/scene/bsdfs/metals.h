#pragma once
// Optical constants of metals and other absorbing substances under the names that Mitsuba 3 gives them: complex indices of
// refraction η − iκ, as measured (E. D. Palik, Handbook of Optical Constants of Solids; the SOPRA and Luxpop databases), in
// the colours that Mitsuba 3 makes of the spectra in its RGB mode.

#include "core/base/vector.h"

#include <string>
#include <string_view>
#include <vector>

namespace ulam {

struct Metal {
    const char* name;
    Spectrum eta, k;
};

/// Nothing where no metal has that name.
const Metal* findMetal(std::string_view name);
/// All names, "none" (η = 0, κ = 1: a perfect mirror) first.
std::vector<std::string> metalNames();

}  // namespace ulam
