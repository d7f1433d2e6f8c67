#pragma once
// Small scenes that between them have every kind of light, BSDF, shape and every special case a path can meet.

#include <string>
#include <vector>

#include "core/scene/load.h"

namespace ulam {

struct PathScene {
    std::string name;
    Json dictionary;
    bool hasDelta = false;  ///< mirrors or glass
    bool infiniteLight = false;
};

SceneDescription describeScene(const Json& dictionary);
/// Built with a film of 32×24 pixels, unless the dictionary says otherwise.
Scene buildScene(const Json& dictionary, const Json& film = {{"width", 32}, {"height", 24}});

/// diffuse: a room lit by a rectangle; glass_and_mirror: with a glass ball, a mirror ball and a two-sided sheet;
/// point_light; environment: objects under a constant sky; many_lights: a rectangle, a ball, a mesh, a point and the
/// sky at once; shading_normals: a curved surface made of few triangles; rough: microfacets, coats and a pane; thin_lens: depth of field, a spot, a cut-out
/// sheet; sun_and_sky: a picture of the sky, parallel light, textures, a disc and a cylinder; layers: mixtures, masks, bumps;
/// instances: shape groups placed by any affine maps; clear_sky: a sky above its horizon, with a wide sun.
const std::vector<PathScene>& pathScenes();
/// By name.
const PathScene& pathScene(const std::string& name);

}  // namespace ulam
