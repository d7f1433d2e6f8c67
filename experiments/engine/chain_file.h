#pragma once
// Where the chains of one run have been, as a file for those who analyse chains: NumPy's .npy, which every numerical
// environment reads (NEP 1, version 1.0).

#include <filesystem>

#include "core/config/json.h"
#include "core/render/statistics.h"

namespace ulam {

/// Chains that are kept of a run, evenly spaced among all.
inline constexpr std::size_t kKeptChains = 64;

/// {"file", "chains", "draws", "scalars"} of what writeChains writes; null without a draw.
Json chainFileJson(const std::vector<ChainTrace>& traces);

/// FOLDER/chains.npy: 32-bit floats [chain][draw][scalar] (ChainTrace::kNames), draws of all chains at the same turns.
/// A feature of -1 is none. Nothing is written without a draw.
void writeChains(const std::filesystem::path& folder, const std::vector<ChainTrace>& traces);

}  // namespace ulam
