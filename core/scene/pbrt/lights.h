#pragma once
// LightSource and AreaLightSource.

#include "core/scene/pbrt/shapes.h"

namespace ulam::pbrt {

/// An entry for a light; null where it is left out.
Json readLight(const std::string& type, const Parameters& parameters, const Matrix4& toWorld, Dictionary& dictionary);

/// The emitter of a shape; null where it is left out.
Json readAreaLight(const std::string& type, const Parameters& parameters, const ShapeRecord& shape,
                   Dictionary& dictionary);

}  // namespace ulam::pbrt
