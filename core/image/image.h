#pragma once

#include <cstddef>
#include <vector>

#include "core/base/vector.h"

namespace ulam {

/// A picture in linear scene-referred RGB (Rec. 709 primaries). Row 0 is the top one; pixels are stored row by row.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<Rgb> pixels;

    Image() = default;
    Image(int w, int h, const Rgb& fill = Rgb(0))
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}

    Rgb& at(int x, int y) { return pixels[index(x, y)]; }
    const Rgb& at(int x, int y) const { return pixels[index(x, y)]; }

    bool operator==(const Image&) const = default;

    template <class Archive>
    void archive(Archive& a) {
        a(width, height, pixels);
    }

private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
};

}  // namespace ulam
