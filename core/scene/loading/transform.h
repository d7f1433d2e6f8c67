#pragma once
// `to_world`: 16 numbers in row-major order, 4 rows of 4, one step, or a list of steps applied first to last
// (translate, rotate, scale, lookat).

#include "core/base/vector.h"
#include "core/config/json.h"

#include <array>
#include <optional>

namespace ulam {

/// Coordinates beyond this are refused: products of edges overflow in single precision.
inline constexpr double kLargestCoordinate = 1e15;

/// In Imath's convention (points are rows, p' = p M). Null is the identity. Fails, with the place, where the result is
/// not affine, not finite or not invertible.
Matrix4 parseTransform(const JsonNode& node);

/// Three numbers that single precision can work with.
Vec3d parseVector(const JsonNode& node);

/// The factor of a transformation that keeps angles (negative when it mirrors); nothing for any other.
std::optional<double> uniformScale(const Matrix4& m);

/// Directions of the object's axes in the world, for a transformation that keeps angles.
std::array<Vec3f, 3> axesOf(const Matrix4& m);

double linearDeterminant(const Matrix4& m);

}  // namespace ulam
