#pragma once
// The scenes that mutations and samplers are audited in: small, and between them with every kind of path.

#include <memory>
#include <string>
#include <vector>

#include "core/config/json.h"
#include "core/path/walk.h"

namespace ulam::audit {

struct AuditScene {
    std::string name, holds;
    Json dictionary;
    Scene scene;
    PathLimits limits;  ///< paths of up to six edges; Russian roulette early, so that it plays a part
};

/// "diffuse": a box with an area light and a block. "specular": the same with a mirror and a glass sphere around a
/// diffuse one and a lamp, so that specular chains stand on either side of diffuse vertices and behind a light. "outdoor": a point light and a
/// constant environment on a mesh with smooth normals, without specular surfaces. "lens": the specular box through a
/// thin lens, with a spot and a cut-out sheet. "rough": rough metal and glass, coats and a pane, in the sun.
/// "textured": textures under a clear sky, through a wide filter and a crop window whose border cuts a lamp. Built once
/// a process.
const std::vector<std::unique_ptr<const AuditScene>>& auditScenes();

}  // namespace ulam::audit
