#pragma once
// Parameters in Mitsuba's XML: elements such as <float name="radius" value="2"/> as values of a scene dictionary.

#include "core/scene/mitsuba/values.h"

#include <pugixml.hpp>

namespace ulam {

/// What is wrong with a value; whoever knows its place says where.
struct PropertyError {
    std::string message, hint;
};

struct PropertyContext {
    bool old;          ///< a version below 2: spectra may be colours, elements <srgb> and <blackbody> exist
    bool emits;        ///< inside an emitter: spectra are light
    std::string name;  ///< of the parameter
};

/// Number, string, vector, colour, or steps of a transformation.
Json readProperty(const pugi::xml_node& element, const PropertyContext& context);
/// A <spectrum> whose curve stands in a file of its own.
Json readSpectrumFile(std::string_view text, const PropertyContext& context);
/// The colour that a plugin for spectra stands for (`uniform`, `blackbody`, …); nothing for other plugins.
std::optional<Json> plainSpectrum(const Json& plugin, bool emits);

}  // namespace ulam
