#pragma once
// The radiance of a clear sky and of the sun in it.
//
// L. Hosek, A. Wilkie: "An analytic model for full spectral sky-dome radiance", ACM Trans. Graph. 31(4), 2012.
// L. Hosek, A. Wilkie: "Adding a solar-radiance function to the Hosek–Wilkie skylight model", IEEE CG&A 33(3), 2013.
//
// Turbidity is 1 (pure air) to 10 (hazy), the albedo of the ground 0 to 1 in each channel, angles are in radians,
// elevations 0 to π/2. Units: hosek_wilkie_data.h.

#include <array>

#include "core/base/vector.h"

namespace ulam {

class SkyModel {
public:
    SkyModel(double turbidity, const Spectrum& albedo, double sunElevation);

    /// Without the sun. `cosTheta` ≥ 0: cosine of the angle to the zenith; `gamma`: angle to the sun. At sunset and just
    /// above the horizon the model falls below 0; that is 0 here.
    Spectrum radiance(double cosTheta, double gamma) const;

private:
    struct Channel {
        std::array<double, 9> shape;  ///< A, B, C, D, E, F, G, I, H of equations 8 and 9
        double radiance;
    };
    std::array<Channel, 3> channels_;
};

/// What the whole disc sends through a surface across its rays. Below 2° it stays what it is there; where the sun is
/// redder than any colour of Rec. 709, the negative blue is 0.
Spectrum sunIrradiance(double turbidity, double sunElevation);

}  // namespace ulam
