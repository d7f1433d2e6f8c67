#pragma once
// Camera, Film and PixelFilter as one sensor.

#include "core/scene/pbrt/dictionary.h"

namespace ulam::pbrt {

/// A directive of which a scene has one.
struct Single {
    std::string type;
    Parameters parameters;
};

/// `toWorld`: from pbrt's camera space, where x is to the right, y up and z the view.
Json readSensor(const Single& camera, const Matrix4& toWorld, const Single& film, const Single& filter);

}  // namespace ulam::pbrt
