#pragma once
// A second, independent writing of every BSDF and layer, for tests and the validator: from the literature, with angles and
// complex numbers, in double, nothing shared with the first but parameters and tabulated data.

#include "core/path/varnish.h"

namespace ulam {

/// Red, green and blue f_s, the density towards the camera and that towards the light, from the lobe and both directions in
/// the frame of the shading normal.
using Factors = std::array<double, 5>;

Factors factorsOf(const Diffuse& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const Conductor& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const Dielectric& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const ThinDielectric& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const Null& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const Plastic& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const RoughConductor& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const RoughDielectric& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const RoughPlastic& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const RoughDiffuse& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const Phong& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const Ward& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const Principled& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const MixtureAt& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const ReliefAt& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);
Factors factorsOf(const VarnishAt& bsdf, Lobe lobe, const Vec3d& l, const Vec3d& c);

}  // namespace ulam
