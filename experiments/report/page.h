#pragma once
// The files of page/, compiled in: the build writes page.cpp from them (embed.cmake).

#include <string_view>

namespace ulam::page {

extern const std::string_view kTemplate;  ///< HTML with the places @TITLE@ @STYLE@ @DATA@ @IMAGES@ @SCRIPT@
extern const std::string_view kStyle;
extern const std::string_view kWatch;  ///< the page around a report that changes
extern const std::string_view kScript;  ///< all modules of page/, in the order of CMakeLists.txt

}  // namespace ulam::page
