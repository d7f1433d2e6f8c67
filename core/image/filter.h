#pragma once
// Reconstruction filters h(x)·h(y) with ∫h = 1 (Mitsuba 3 `box`, `tent`, `gaussian`). A pixel's value is the radiance
// convolved with the filter around its centre. Camera paths draw their raster offset from h; light-image and chain
// deposits are weighted with h: all have the same expectation, at image borders too.

#include "core/base/vector.h"

#include <string>

namespace ulam {

class ReconstructionFilter {
public:
    enum class Type { Box, Tent, Gaussian };

    struct GaussianParameters {
        double stddev = 0.5;
        template <class V>
        void describe(V& v) {
            v("stddev", stddev, {.help = "standard deviation; the filter ends at 4 of them", .unit = "pixels", .min = 0.05, .max = 4});
        }
    };
    struct TentParameters {
        double radius = 1;
        template <class V>
        void describe(V& v) {
            v("radius", radius, {.help = "half width", .unit = "pixels", .min = 0.1, .max = 16});
        }
    };
    struct BoxParameters {
        template <class V>
        void describe(V&) {}
    };

    ReconstructionFilter() = default;
    explicit ReconstructionFilter(const BoxParameters&) {}
    explicit ReconstructionFilter(const TentParameters& p) : type_(Type::Tent), radius_(p.radius) {}
    explicit ReconstructionFilter(const GaussianParameters& p);

    Type type() const { return type_; }
    /// Half width of the support in pixels.
    float radius() const { return float(radius_); }
    /// One axis, at a distance from the pixel's centre.
    double operator()(double x) const;
    /// ∫ h² over one axis: a pixel's variance from splats is that of a box, whose value is 1, times both axes' ∫ h².
    double squareIntegral() const;
    /// An offset from the pixel's centre distributed as h.
    double sample(double u) const;

private:
    Type type_ = Type::Box;
    double radius_ = 0.5;
    double stddev_ = 0, atRadius_ = 0, normalization_ = 1;
};

}  // namespace ulam
