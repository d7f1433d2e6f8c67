#pragma once
// Mesh files as bytes, to meshes in their own coordinates and back. Errors are ExitCode::InvalidConfig and name file and line or
// byte. Sizes that a file announces are checked against its length before anything is allocated.

#include <string>
#include <string_view>

#include "core/scene/shape.h"

namespace ulam {

/// Wavefront OBJ: v, vt, vn and f; polygons become fans; negative indices count from the end; all groups and objects
/// become one mesh; lines of other kinds are skipped. Vertices are split where normals or texture coordinates differ.
Mesh readObj(std::string_view bytes, std::string_view name, bool flipTexCoords);

/// Stanford PLY 1.0: ascii, binary little and big endian; properties x y z, nx ny nz, u v (or s t), and faces as lists
/// vertex_index or vertex_indices; polygons become fans; other elements and properties are skipped.
Mesh readPly(std::string_view bytes, std::string_view name);

struct SerializedMesh {
    Mesh mesh;
    bool faceNormals;  ///< it is meant to be shaded flat
};
/// Mitsuba's .serialized, versions 3 and 4: the mesh of this number, counted from 0. Colours are skipped.
SerializedMesh readSerialized(std::string_view bytes, std::string_view name, int index);

/// Stanford PLY 1.0, binary little endian: x y z, and nx ny nz and u v where the mesh has them. readPly gives the same
/// mesh back, bit for bit.
std::string plyBytes(const Mesh& mesh);

}  // namespace ulam
