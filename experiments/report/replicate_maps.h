#pragma once
// What the replicates of a cell tell about each pixel: their mean, how much they scatter, and whether the mean is the
// reference's.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/image/image.h"

namespace ulam {

/// A byte for each block of the image, row by row from the top.
struct ByteMap {
    int block = 1;  ///< edge of a block in pixels; blocks at the right and lower edges may be cut
    int width = 0, height = 0;
    std::vector<std::uint8_t> bytes;
};

/// The reference of a cell with the variance of its pixels.
struct MapReference {
    Image image, variance;
    double degrees = 0;  ///< of the variance; infinite where it is known
};

struct ReplicateMaps {
    Image mean;
    /// Of luminance, relative as in relMSE: s / √(mean² + 0.01). 0 is none; else 10^(6 (byte − 1) / 254 − 3).
    ByteMap deviation;
    /// Is the mean the reference? 0: not judged; else log10 of p = −|byte − 128| / 20, above 128 too bright, below too
    /// dark; p adjusted for a false discovery rate over the judged blocks of the map. Of blocks just large enough that
    /// at least kJudgedShare of them can be judged, or else of the largest.
    std::optional<ByteMap> tests;
};

inline constexpr double kJudgedShare = 0.9;
inline constexpr int kLargestBlock = 16;  ///< in blocks of `deviation`
/// The tests keep the blocks of all replicates in memory: no more than these.
inline constexpr double kTestedBlocks = 1 << 24;

/// Of the images of at least one replicate, all of one size. Blocks of `deviation` have an edge of `block` pixels.
/// Tests need a reference of the same size and two replicates. A block's p is that of statistics::skewedMeanP for
/// luminance; the standard deviations of the reference's channels and of the pixels of a block are added as if they
/// varied together, which is on the safe side. Blocks that never vary are not judged. Fails with InvalidConfig where
/// sizes differ.
ReplicateMaps mapReplicates(const std::vector<std::filesystem::path>& files, const MapReference* reference, int block);

}  // namespace ulam
