#pragma once
// What may stand in a scene, as a page.

#include <string>

namespace ulam {

/// Tables in Markdown of all scene plugins with their parameters, and the names of Mitsuba's that are missing.
std::string sceneVocabulary();

}  // namespace ulam
