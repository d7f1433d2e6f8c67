#pragma once
// Scenes in the text format of pbrt-v4.

#include <filesystem>

#include "core/config/json.h"

namespace ulam {

/// Deepest inclusion of files in files, and the bytes of all of them together, however often they are included.
inline constexpr int kMaxPbrtIncludes = 15;
inline constexpr std::size_t kMaxPbrtBytes = std::size_t{2} << 30;

/// The scene dictionary of a file: file names start at its folder. Every value knows its directive's file, line and
/// column. World coordinates stay as they are: pbrt's camera has x to the right where Mitsuba's has it to the left, and
/// that is all that its left-handed world means. Fails with InvalidConfig at directives, plugins and parameters that
/// are not known. `lenient`: unknown materials and textures become magenta, unknown shapes and lights are left out;
/// "$substitutions" says so, as it does where a model of pbrt is written as the nearest one.
JsonDocument readPbrt(const std::filesystem::path& file, bool lenient = false);

}  // namespace ulam
