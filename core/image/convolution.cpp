#include "core/image/convolution.h"

#include <algorithm>
#include <cstring>

namespace ulam {
namespace {

constexpr int kLanes = 8;
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float))));

Lanes load(const float* from) {
    Lanes lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
}

}  // namespace

Convolver::Convolver(int width, int height) : width_(width), height_(height), between_(offset(height)) {}

/// A row of the sum of the kernel's taps, that at i times the row that begins at sourceOf(i).
template <class SourceOf>
void Convolver::weigh(const Kernel& kernel, float* out, SourceOf sourceOf) {
    const int radius = static_cast<int>(kernel.size()) / 2;
    sources_.clear();
    for (int i = -radius; i <= radius; ++i) sources_.push_back(sourceOf(i));
    int x = 0;
    for (constexpr int kTogether = 4 * kLanes; x + kTogether <= width_; x += kTogether) {
        Lanes a{}, b{}, c{}, d{};  // sums that stay in registers
        for (std::size_t tap = 0; tap < kernel.size(); ++tap) {
            const float* source = sources_[tap] + x;
            a += kernel[tap] * load(source);
            b += kernel[tap] * load(source + kLanes);
            c += kernel[tap] * load(source + 2 * kLanes);
            d += kernel[tap] * load(source + 3 * kLanes);
        }
        for (const Lanes& sum : {a, b, c, d}) {
            std::memcpy(out, &sum, sizeof sum);
            out += kLanes;
        }
    }
    for (; x < width_; ++x) {
        float sum = 0;
        for (std::size_t tap = 0; tap < kernel.size(); ++tap) sum += kernel[tap] * sources_[tap][x];
        *out++ = sum;
    }
}

void Convolver::horizontal(const Plane& in, const Kernel& kernel, Plane& out) {
    const int radius = static_cast<int>(kernel.size()) / 2;
    row_.resize(width_ + 2 * radius);
    for (int y = 0; y < height_; ++y) {
        const float* source = in.data() + offset(y);
        for (int x = -radius; x < width_ + radius; ++x) row_[x + radius] = source[std::clamp(x, 0, width_ - 1)];
        // The tap at +i weighs the pixel at x - i.
        weigh(kernel, out.data() + offset(y), [&](int i) { return row_.data() + radius - i; });
    }
}

void Convolver::vertical(const Plane& in, const Kernel& kernel, Plane& out) {
    for (int y = 0; y < height_; ++y) {
        weigh(kernel, out.data() + offset(y),
              [&](int i) { return in.data() + offset(std::clamp(y - i, 0, height_ - 1)); });
    }
}

void Convolver::both(const Plane& in, const Kernel& kernel, Plane& out) {
    horizontal(in, kernel, between_);
    vertical(between_, kernel, out);
}

}  // namespace ulam
