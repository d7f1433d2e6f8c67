#pragma once
// Scenes in Mitsuba's XML, of Mitsuba 2 and 3 and, in their spelling, of 0.4 to 0.6.

#include "core/config/json.h"
#include "core/scene/loading/file_options.h"

#include <filesystem>

namespace ulam {

/// Deepest nesting of elements, and of files that include each other.
inline constexpr int kMaxXmlDepth = 64, kMaxIncludes = 15;
/// Bytes of all included files together, however often they are included, and of an attribute's value once definitions are in it.
inline constexpr std::size_t kMaxXmlBytes = std::size_t{2} << 30, kMaxXmlAttribute = std::size_t{1} << 20;

/// The scene dictionary of a file. Every value knows its element's file, line and column. Names and values of versions
/// below 2 are brought to Mitsuba 3's (upgrade.h). Spectra become colours (spectra.h), file names start at the folder of
/// `file`. Fails with InvalidConfig at elements, attributes and values that Mitsuba does not know either, at files outside
/// of that folder, and at definitions that the file never asks for.
JsonDocument readMitsubaXml(const std::filesystem::path& file, const SceneFileOptions& options = {});

}  // namespace ulam
