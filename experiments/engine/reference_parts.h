#pragma once
// The independent parts a reference is made of, and what they amount to. Parts can be added to those that were combined
// before, whose images are gone by then.

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

    /// The smallest p over the tiles that the halves have one mean (Welch, Holm).
    double smallestP() const;
};

/// Of parts with the numbers from before.parts on. Together there must be at least two in each half.
CombinedParts combineParts(const std::vector<Image>& parts, const CombinedParts& before = {});

/// [{"degrees", "mean": [...], "variance_of_mean": [...]} of each half]
Json halvesJson(const CombinedParts& combined);
/// Fails with InvalidConfig where it is not that.
std::array<std::vector<statistics::MeanEstimate>, 2> halvesFromJson(const JsonNode& json);

}  // namespace ulam
