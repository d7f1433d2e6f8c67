#pragma once
// Values that are not finite, noticed where light is computed. A bad value is refused there, so that it never reaches a sum
// or a file, and its cause stays noted until whoever makes the sample asks: like errno, for one thread.

#include <cmath>
#include <cstdint>
#include <utility>

namespace ulam {

/// What was not finite.
enum class Cause : uint8_t {
    None,
    Geometry,      ///< a position or normal
    Texture,
    BsdfValue,     ///< or a BSDF's density, direction or albedo
    Light,         ///< a radiance or density of an emitter
    Sensor,        ///< an importance or density of the camera
    Target,        ///< π
    Mutation,      ///< what a mutation proposed: numbers, suitability, densities
    Contribution,  ///< the product of finite factors
};

inline const char* name(Cause cause) {
    constexpr const char* names[] = {"none", "geometry", "texture", "bsdf", "light", "sensor", "target", "mutation", "contribution"};
    return names[int(cause)];
}

namespace detail {
inline constinit thread_local Cause noted = Cause::None;
/// Notes the cause unless an earlier one is; false. Out of line, to keep the code around the checks small.
[[gnu::cold, gnu::noinline]] bool note(Cause cause);
}

/// Whether a value is finite; else its cause is noted, unless an earlier one is. To check several values, give their sum.
inline bool checkFinite(Cause cause, double sum) {
    if (std::isfinite(sum)) [[likely]] return true;
    return detail::note(cause);
}

/// The first cause since this was asked last.
inline Cause takeCause() { return std::exchange(detail::noted, Cause::None); }

}  // namespace ulam
