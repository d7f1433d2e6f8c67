#pragma once
// Spectra as colours: linear Rec. 709, as Mitsuba 3 makes them of spectra in its RGB mode.

#include <Imath/ImathVec.h>

#include <vector>

namespace ulam {

/// Values at wavelengths, linear in between; 0 outside.
struct SpectralCurve {
    std::vector<double> wavelengths;  ///< in nanometres, ascending
    std::vector<double> values;
};

enum class SpectrumUse {
    Reflectance,  ///< under D65, cut to [0, 1]
    Unbounded,    ///< under D65, at least 0: indices of refraction and the like
    Emission,     ///< as it is, at least 0: the same power at all wavelengths is a little red
};

/// Through the CIE observer of 1931 (2 degrees).
Imath::V3d toRgb(const SpectralCurve& curve, SpectrumUse use);

/// A black body's radiance in W / (m² sr nm) (Planck), through the same observer.
Imath::V3d blackbodyRgb(double kelvin);

}  // namespace ulam
