#pragma once

#include <cstring>

#include "core/image/image.h"

namespace ulam {

inline bool sameBytes(const Image& a, const Image& b) {
    return a.pixels.size() == b.pixels.size() &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Rgb)) == 0;
}

}  // namespace ulam
