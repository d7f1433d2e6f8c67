#pragma once
// References: what images are compared with. A sampler makes one in independent parts, half of them in each of two
// halves that must agree; the parts also give the variance of their mean, pixel by pixel.

#include "experiments/engine/plan.h"
#include "experiments/statistics/welch.h"

namespace ulam {

/// Level at which halves disagree, over all tiles of the image (Holm).
inline constexpr double kHalvesLevel = 1e-3;
/// Edge of a tile in pixels.
inline constexpr int kTileSize = 16;

struct Reference {
    Image image, variance;  ///< variance of the mean image; zero where the image is exact
    bool halvesAgree = true;
    /// Share of each of the scene's features in the image's energy; empty where not known.
    std::vector<statistics::MeanEstimate> featureShares;
};

/// The image, its variance and the smallest adjusted p over tiles from the parts of a reference.
struct CombinedParts {
    Image image, variance;
    double smallestP = 1;
};
/// The first half of the parts against the second; at least two parts a half.
CombinedParts combineParts(const std::vector<Image>& parts);

/// RUN_DIR/references/KEY holds the reference: from this run, from the cache across runs, from a file, or exact. False
/// where a sampler still has to make parts. What is damaged, in the run or in the cache, is removed.
bool prepareReference(const PlannedReference& reference, const std::filesystem::path& runDir);
/// Where the parts of a reference stand until it is complete.
std::filesystem::path partsFolder(const PlannedReference& reference, const std::filesystem::path& runDir);
/// Combines the finished parts, writes image.exr, variance.exr and result.json, fills the cache, removes the parts.
/// Fails with InvalidConfig where the image is black.
void finishReference(const PlannedReference& reference, const std::filesystem::path& runDir);
/// Of a prepared or finished reference.
Reference readReference(const PlannedReference& reference, const std::filesystem::path& runDir);

/// Does the cache hold it, undamaged?
bool isCached(const PlannedReference& reference);

/// $XDG_CACHE_HOME/ulam/references, or ~/.cache/ulam/references.
std::filesystem::path referenceCache();

}  // namespace ulam
