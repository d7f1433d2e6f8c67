#pragma once
// The independent parts a reference is made of, and what they amount to. Parts can be added to those that were combined
// before, whose images are gone by then; what comes out is the same, bit by bit, as if all had been combined at once.

#include <array>

#include "core/config/json.h"
#include "core/image/image.h"
#include "experiments/statistics/welch.h"

namespace ulam {

/// Edge of a tile in pixels.
inline constexpr int kTileSize = 16;

struct CombinedParts {
    int parts = 0;
    Image image, variance;  ///< the mean, and the variance of the mean
    /// Mean luminance of every tile, row by row, in the half of the parts with even numbers and in the other one.
    std::array<std::vector<statistics::MeanEstimate>, 2> halves;

    /// The next one, whose number is that of the parts so far.
    void add(const Image& part);
    /// The smallest p over the tiles that the halves have one mean (Welch, Holm). There must be at least two parts in
    /// each half.
    double smallestP() const;
};

/// Combines each estimate with one value more; without estimates yet they are of one value each.
void addValues(std::vector<statistics::MeanEstimate>& estimates, const std::vector<double>& values);

/// [{"degrees", "mean": [...], "variance_of_mean": [...]} of each half]
Json halvesJson(const CombinedParts& combined);
/// Fails with InvalidConfig where it is not that.
std::array<std::vector<statistics::MeanEstimate>, 2> halvesFromJson(const JsonNode& json);

}  // namespace ulam
