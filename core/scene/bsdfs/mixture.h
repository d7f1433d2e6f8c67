#pragma once
// What is made of parts that are sampled apart: one number chooses the part.

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace ulam {

/// A part, and where in its share of the number that chose it: uniform in [0,1].
struct ChosenPart {
    size_t index;
    double within;
};
/// The part that `at`, from 0 to the weights' sum, falls into. None where all weights are 0.
inline std::optional<ChosenPart> partAt(std::span<const double> weights, double at) {
    std::optional<ChosenPart> part;
    for (size_t i = 0; i < weights.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        part = ChosenPart{i, std::min(1.0, at / weights[i])};
        if (at < weights[i]) break;
        at -= weights[i];
    }
    return part;
}

/// The part that u in [0,1) chooses with probabilities as these weights.
inline std::optional<ChosenPart> choosePart(std::span<const double> weights, double u) {
    double total = 0;
    for (const double weight : weights) total += weight;
    return partAt(weights, u * total);
}

/// The number that partAt() takes to this part.
inline double numberOf(std::span<const double> weights, const ChosenPart& part) {
    double start = 0;
    for (size_t i = 0; i < part.index; ++i) start += weights[i];
    return start + weights[part.index] * part.within;
}

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
    const auto part = choosePart(densities, u);
    if (!part) return std::nullopt;
    u = numberOf(probabilities, *part);
    return part->index;
}

}  // namespace ulam
