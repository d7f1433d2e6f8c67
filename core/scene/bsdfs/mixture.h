#pragma once
// One smooth lobe made of parts that are sampled apart: one number chooses the part.

#include <array>
#include <cstddef>
#include <optional>

namespace ulam {

/// The part that u chooses with these probabilities, which sum to 1.
template <size_t N>
size_t chosenPart(const std::array<double, N>& probabilities, double u) {
    size_t part = 0;
    for (double end = probabilities[0]; part + 1 < N && !(u < end); end += probabilities[part]) ++part;
    return part;
}

/// Any part may have made a direction, with probabilities as their densities of it. Chooses one with u, and replaces u by a
/// number that chooses the same part: it has the law of u given the direction. None where all densities are 0.
template <size_t N>
std::optional<size_t> invertPart(const std::array<double, N>& probabilities, const std::array<double, N>& densities, double& u) {
    double total = 0, start = 0;
    for (const double density : densities) total += density;
    double at = u * total;
    std::optional<size_t> part;
    for (size_t i = 0; i < N; ++i) {
        if (densities[i] > 0) {
            part = i;
            u = start + probabilities[i] * std::min(1.0, at / densities[i]);
            if (at < densities[i]) break;
            at -= densities[i];
        }
        start += probabilities[i];
    }
    return part;
}

}  // namespace ulam
