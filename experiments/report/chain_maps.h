#pragma once
// What runs of a sampler with chains tell about each place of the image: whether their chains get there and away.

#include <filesystem>
#include <optional>
#include <vector>

#include "experiments/report/replicate_maps.h"

namespace ulam {

/// Edge of the blocks of an R-hat, in blocks of the page's maps: their pixels' variances are added.
inline constexpr int kRhatBlock = 4;

/// R-hat of the luminance of the pixels of each block, with the replicates in place of chains and the first and the
/// second half of each run as its two draws: √((1 + between / within) / 2), where `within` is the variance of one
/// mutation's deposit as it follows from the difference between the halves, and `between` the same from the differences
/// between runs (Gelman & Rubin 1992 for two draws). Near 1 where a half tells as much as another run; large where each
/// run stays with what it has found. Images are divided by their run's normalization, which both halves share. Byte 0:
/// nothing varies there; else R-hat = 2^((byte − 1) / 64 − 1), at most 7.8. From the folders of the replicates; none with
/// fewer than two of them or without a snapshot between two halves. Fails with InvalidConfig where sizes differ.
std::optional<ByteMap> mapRhat(const std::vector<std::filesystem::path>& replicates, int block);

/// Share of the proposals made from states in each block that were accepted, over all replicates that left extra/proposed.exr
/// and extra/accepted.exr; none where none did. Byte 0: no state was there; else the share is (byte − 1) / 254.
std::optional<ByteMap> mapAcceptance(const std::vector<std::filesystem::path>& replicates, int block);

}  // namespace ulam
