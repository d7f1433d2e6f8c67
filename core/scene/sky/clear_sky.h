#pragma once
// A clear sky and its sun as an environment map: the sky of hosek_wilkie.h as a picture of the upper hemisphere, the sun
// as a disc of constant radiance.

#include "core/scene/environment_map.h"

namespace ulam {

struct ClearSky {
    double turbidity = 3;
    Spectrum albedo{0.3, 0.3, 0.3};          ///< of the ground
    Vec3f zenith{0, 0, 1}, sun{0, 0, 1};     ///< unit vectors of the world; the sun not below the horizon
    double sunRadius = 0.5358 / 2 * kPi / 180;  ///< half the angle it is seen under; its power does not depend on it
    double skyScale = 1, sunScale = 1;

    EnvironmentMap map() const;
};

}  // namespace ulam
