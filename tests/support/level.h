#pragma once
// How much tests/run asks for: the quick suite, or everything (--full).

#include <cstdlib>
#include <string_view>

namespace ulam {

inline bool fullLevel() {
    const char* level = std::getenv("ULAM_TEST_LEVEL");
    return level && std::string_view(level) == "full";
}

}  // namespace ulam
