#pragma once
// What the perturbations from the camera's end share: `lens` and `multi_chain`.

#include "core/mcmc/perturbation.h"

namespace ulam {

/// Moves the raster position and the point on the lens and follows the path towards the light: through delta vertices by the same lobes, and off
/// other vertices, where the path goes on to a delta vertex, along a slightly changed direction. It stops at x_m, which
/// is joined to the unchanged x_{m−1}.
class LensPerturbation {
public:
    LensPerturbation(const RasterPerturbation& raster, const AnglePerturbation& direction) : raster_(raster), direction_(direction) {}

    /// Where such a perturbation of x stops: the first two vertices in succession without delta, counted from the
    /// camera (or the light itself). `turns`: how often the direction changes at a vertex without delta. −1: x has no
    /// such place.
    static int end(const Path& x, int& turns);

    Proposal propose(const Sample& x, int m, StepContext& context) const;
    /// log q(from → to) for both ending at m.
    double logDensity(const Tracing& tracing, const Sample& from, const Sample& to, int m) const;

private:
    static Perspective::Response response(const Scene& scene, const Sample& s);
    double logDensity(const Tracing& tracing, const Sample& from, const Perspective::Response& a, const Sample& to, const Perspective::Response& b,
                      int m) const;

    RasterPerturbation raster_;
    AnglePerturbation direction_;
};

}  // namespace ulam
