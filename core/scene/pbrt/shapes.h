#pragma once
// Shapes in their own coordinates, and as entries of the dictionary once it is known where they stand.

#include <memory>

#include "core/scene/pbrt/materials.h"

namespace ulam::pbrt {

struct ShapeRecord {
    Json plugin;  ///< without what depends on the place
    Matrix4 toWorld;
    bool reversed = false;  ///< ReverseOrientation
    Parametrization parametrization = Parametrization::Same;
    // Of a `mesh`, before toWorld:
    std::vector<double> positions, normals, texcoords, indices;
    bool lacksTexcoords = false;  ///< of a mesh in a file
    MaterialUse material;
    std::optional<Texture> alpha;
    Json emitter;  ///< null: none
    Place place;

    bool isMesh() const { return plugin["type"] == "mesh"; }
};

/// A Shape directive; nothing where it is left out. The caller adds material and light.
std::optional<ShapeRecord> readShape(const std::string& type, const Parameters& parameters, const Matrix4& toWorld,
                                     bool reversed, const Textures& textures, Dictionary& dictionary);

/// Area in the world. Of a mesh that of one triangle where all have the same: pbrt makes each a light of its own.
std::optional<double> lightArea(const ShapeRecord& shape);

/// The entry of a shape that is moved once more, as by an instance.
Json shapeEntry(const ShapeRecord& shape, const Matrix4& moved, Materials& materials);

}  // namespace ulam::pbrt
