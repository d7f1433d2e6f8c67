#pragma once
// Mutations with planted bugs, to see that the audit finds them. Only test programs hold them.

namespace ulam::planted {

/// Registers, once, perturbations of the raster position: planted_none, which is right; planted_geometry, whose
/// densities lack the conversion to area; planted_swapped, with forward for reverse; planted_blind, without visibility;
/// planted_silent, like planted_geometry but without logDensity; planted_nowhere, which suits no state. And
/// planted_drift, a step of primary numbers that is not symmetric but says so. Two are right where only ratios count, but
/// their densities are not those of their proposals: planted_overfull, and planted_narrow, a step of primary numbers. Of targets: planted_blueblind
/// and planted_squared.
void registerAll();

}  // namespace ulam::planted
