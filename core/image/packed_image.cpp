#include "core/image/packed_image.h"

#include <algorithm>
#include <bit>

namespace ulam {
namespace {

/// Numbers the different values of an image, up to 65536 of them, as bits: zeros of both signs are two.
class ValueNumbers {
public:
    static constexpr std::size_t kMost = 65536;

    /// The number of a value, or kMost where there are too many.
    std::size_t operator()(float value) {
        const auto bits = std::bit_cast<uint32_t>(value);
        // Hashed; at most half of the slots are ever taken.
        for (std::size_t i = bits * 0x9e3779b1u >> 15;; i = (i + 1) % slots_.size()) {
            if (slots_[i] == 0) {
                if (values.size() == kMost) return kMost;
                values.push_back(value);
                slots_[i] = uint32_t(values.size());
                return values.size() - 1;
            }
            if (std::bit_cast<uint32_t>(values[slots_[i] - 1]) == bits) return slots_[i] - 1;
        }
    }

    std::vector<float> values;

private:
    std::vector<uint32_t> slots_ = std::vector<uint32_t>(2 * kMost);  // one more than the number; 0: free
};

bool isGrey(const Rgb& p) {
    const auto bits = [](float v) { return std::bit_cast<uint32_t>(v); };
    return bits(p.x) == bits(p.y) && bits(p.x) == bits(p.z);
}

}  // namespace

PackedImage::PackedImage(const Image& image)
    : width_(image.width), height_(image.height), channels_(std::ranges::all_of(image.pixels, isGrey) ? 1 : 3) {
    const std::size_t count = image.pixels.size() * channels_;
    const auto valueAt = [&](std::size_t i) { return image.pixels[i / channels_][int(i % channels_)]; };
    ValueNumbers numbers;
    shorts_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t number = numbers(valueAt(i));
        if (number == ValueNumbers::kMost) {
            shorts_ = {};
            floats_.reserve(count);
            for (std::size_t k = 0; k < count; ++k) floats_.push_back(valueAt(k));
            return;
        }
        shorts_.push_back(uint16_t(number));
    }
    table_ = std::move(numbers.values);
    if (table_.size() > 256) return;
    bytes_.assign(shorts_.begin(), shorts_.end());
    shorts_ = {};
}

}  // namespace ulam
