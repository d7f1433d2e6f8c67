#pragma once
// From meshes and spheres in their own coordinates to those of the world, checked.

#include "core/scene/loading/context.h"
#include "core/scene/shape.h"

namespace ulam {

struct MeshPlacement {
    Matrix4 toWorld;
    bool flipNormals = false;
    /// Vertex normals: those given, computed ones where none are given, or none at all.
    enum class Normals { Given, Smooth, Flat } normals = Normals::Given;
};

/// Transforms a mesh and drops its degenerate triangles (with a warning that counts them). Fails, naming the shape's
/// place, where a vertex is not finite, an index points nowhere or nothing is left.
Mesh placeMesh(Mesh mesh, const MeshPlacement& placement, const JsonNode& shape, LoadContext& context);

/// Unit normals of vertices: the mean of the adjacent triangles' normals weighted by their angles at the vertex
/// (Thürmer and Wüthrich 1998, "Computing vertex normals from polygonal facets"); zero where a vertex has no triangle.
std::vector<Vec3f> vertexNormals(const Mesh& mesh);

}  // namespace ulam
