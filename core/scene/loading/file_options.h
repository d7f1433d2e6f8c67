#pragma once
// How scene files of other renderers are read.

#include <map>
#include <string>

namespace ulam {

/// What stands for `$name` in a file of Mitsuba's XML; wins over the file's own <default>.
using Definitions = std::map<std::string, std::string>;

struct SceneFileOptions {
    Definitions definitions;
    /// BSDFs and textures that are not known become magenta, such shapes, emitters and media are left out. The
    /// dictionary says so in "$substitutions", and so do the results of all its images.
    bool lenient = false;
};

}  // namespace ulam
