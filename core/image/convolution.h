#pragma once
// Separable convolution of planes of pixels, whose outermost pixels continue beyond the border.

#include <cstddef>
#include <vector>

namespace ulam {

using Plane = std::vector<float>;   // one number a pixel, row by row
using Kernel = std::vector<float>;  // odd number of taps, centred

/// Of planes of one size. Outputs have that size and are not the input.
class Convolver {
public:
    Convolver(int width, int height);

    void horizontal(const Plane& in, const Kernel& kernel, Plane& out);
    void vertical(const Plane& in, const Kernel& kernel, Plane& out);
    void both(const Plane& in, const Kernel& kernel, Plane& out);

private:
    std::size_t offset(int y) const { return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_); }
    template <class SourceOf>
    void weigh(const Kernel& kernel, float* out, SourceOf sourceOf);

    int width_, height_;
    std::vector<float> row_;
    Plane between_;
    std::vector<const float*> sources_;
};

}  // namespace ulam
