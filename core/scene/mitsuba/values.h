#pragma once
// The values that attributes of Mitsuba's XML hold.

#include "core/config/json.h"
#include "core/scene/loading/spectra.h"

#include <optional>
#include <string_view>
#include <vector>

namespace ulam {

/// Words between blanks and commas.
std::vector<std::string_view> words(std::string_view text);

/// Nothing where the text is not one number, or not so many.
std::optional<double> parseNumber(std::string_view text);
std::optional<std::vector<double>> parseNumbers(std::string_view text);

/// "0.5", "0.1 0.2 0.3" or "#rrggbb" (which is encoded as for screens) as a number or [r, g, b]; `encoded`: numbers are too.
std::optional<Json> parseRgb(std::string_view text, bool encoded);

/// "400:0.1, 500:0.3": wavelengths in nanometres, ascending, and values.
std::optional<SpectralCurve> parseCurve(std::string_view text);
/// Lines of a wavelength and a value; "#" begins a remark.
std::optional<SpectralCurve> parseCurveFile(std::string_view text);

}  // namespace ulam
