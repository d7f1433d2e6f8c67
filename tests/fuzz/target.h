#pragma once
// What the fuzzing programs share. The only error that a reader may give is ulam::Error; whatever else it does ends the program.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace ulam {

inline std::string_view bytesOf(const uint8_t* data, size_t size) { return {reinterpret_cast<const char*>(data), size}; }

/// Runs a reader. An error must say something, and must say where.
template <class Function>
void tolerateErrors(std::string_view name, Function&& read) {
    try {
        read();
    } catch (const Error& error) {
        if (std::string_view(error.what()).find(name) == std::string_view::npos) {
            std::fprintf(stderr, "the message does not name %s: %s\n", std::string(name).c_str(), error.what());
            std::abort();
        }
    }
}

/// A condition on what a reader returned.
inline void require(bool condition) {
    if (!condition) std::abort();
}

}  // namespace ulam
