#pragma once
// A picture held in as few bytes as its values allow, for lookups in any order.

#include <cstdint>

#include "core/image/image.h"

namespace ulam {

/// Gives back the pixels of an Image bit for bit. Where few values occur, as in pictures of 8 or 16 bits or of half
/// precision, numbers into a table of them are held; where all pixels are grey, one value each.
class PackedImage {
public:
    explicit PackedImage(const Image& image);

    int width() const { return width_; }
    int height() const { return height_; }
    Rgb at(int x, int y) const {
        const std::size_t i = (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * channels_;
        if (!bytes_.empty()) return pixel([&](std::size_t k) { return table_[bytes_[i + k]]; });
        if (!shorts_.empty()) return pixel([&](std::size_t k) { return table_[shorts_[i + k]]; });
        return pixel([&](std::size_t k) { return floats_[i + k]; });
    }
    /// That the pixels take.
    std::size_t bytes() const { return bytes_.size() + 2 * shorts_.size() + 4 * floats_.size(); }

private:
    template <class Value>
    Rgb pixel(const Value& value) const {
        return channels_ == 1 ? Rgb(value(0)) : Rgb(value(0), value(1), value(2));
    }

    int width_, height_;
    std::size_t channels_;
    std::vector<float> table_;
    // One of these holds the pixels.
    std::vector<uint8_t> bytes_;
    std::vector<uint16_t> shorts_;
    std::vector<float> floats_;
};

}  // namespace ulam
