#pragma once
// Coefficients of the Hosek–Wilkie sky and sun, as colours in linear Rec. 709. Radiances in W / (m² sr nm), irradiances in
// W / (m² nm): that of an equal-energy spectrum of the same luminance.

namespace ulam::sky_data {

inline constexpr int kTurbidities = 10;  // 1, 2, …, 10
inline constexpr int kAlbedos = 2;       // of the ground: 0, 1
inline constexpr int kControlPoints = 6;  // of Bézier curves over the sun's elevation
inline constexpr int kShapeParameters = 9;
inline constexpr int kSunElevations = 30;  // 2°, 5°, …, 89°

/// [turbidity][albedo][control point][channel][parameter]
extern const float kShape[kTurbidities * kAlbedos * kControlPoints * 3 * kShapeParameters];
/// [turbidity][albedo][control point][channel]
extern const float kRadiance[kTurbidities * kAlbedos * kControlPoints * 3];
/// [turbidity][elevation][channel]: across the sun's rays
extern const float kSunIrradiance[kTurbidities * kSunElevations * 3];

}  // namespace ulam::sky_data
