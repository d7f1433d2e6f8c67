#pragma once
// How a path scatters at a vertex.

#include <cstdint>

namespace ulam {

/// A delta lobe's factor δ_σ is left out of both f and every density. δ_σ is the delta distribution with respect to the
/// étendue measure dσ = η²|cosθ| dω, which is the same on both sides of an interface: so what remains of f and of the
/// densities from either end belongs to one and the same product measure, refraction included.
/// Null goes straight on, as if nothing were there.
enum class Lobe : uint8_t { Smooth, DeltaReflection, DeltaTransmission, Null };

inline bool isDelta(Lobe lobe) { return lobe != Lobe::Smooth; }

}  // namespace ulam
