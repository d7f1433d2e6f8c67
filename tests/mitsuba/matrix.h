#pragma once
// Scenes that show every BSDF which Mitsuba 3 has too, under one kind of light.

#include <string>
#include <vector>

#include "core/config/json.h"

namespace ulam {

struct MatrixScene {
    std::string name;
    Json scene, samplers;
};

/// Smooth balls of few triangles, one a BSDF, under an area light, a point light and an environment; plain, and with a
/// texture in the place of every parameter that takes one. A BSDF of Ulam that is in no scene, and not known to be
/// missing in Mitsuba 3, fails the calling test.
std::vector<MatrixScene> matrixScenes();

}  // namespace ulam
