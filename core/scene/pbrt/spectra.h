#pragma once
// Colours of pbrt's spectra: "rgb", "blackbody", "spectrum" with values, a named curve or a file.

#include "core/scene/pbrt/dictionary.h"

namespace ulam::pbrt {

/// As the colour of a surface: "rgb" or "spectrum".
Spectrum reflectance(const Parameters& owner, const Parameter& parameter, const Dictionary& dictionary);

/// As light. pbrt scales all but "rgb" to a luminance of 1; (1,1,1) is "rgb" and the default alike.
Spectrum light(const Parameters& owner, std::string_view name, const Dictionary& dictionary);

/// An index of refraction: one number, the one at the middle of the spectrum.
double index(const Parameters& owner, std::string_view name, double otherwise, Dictionary& dictionary);

/// Optical constants of a metal, under the names of a conductor: `material`, or `eta` and `k`. Copper by default.
Json metal(const Parameters& owner, const std::string& prefix, const Dictionary& dictionary);

}  // namespace ulam::pbrt
