#pragma once
// The chains of one replicate as the page shows them: where each was, draw by draw.

#include <filesystem>
#include <optional>
#include <string>

#include "core/config/json.h"

namespace ulam {

/// A draw in the page: two bytes for each of the place across, the place down and the logarithm of the target, a byte
/// for the path length, a byte for the feature.
inline constexpr int kDrawBytes = 8;

struct ChainData {
    Json fields;        ///< chains, draws, log_target: [lowest, highest]
    std::string bytes;  ///< one scalar after the other, each [chain][draw], little-endian
};

/// Of FOLDER/chains.npy, which `traces` of the replicate's result.json describes; nothing where it has no chains. At
/// most `most` chains, evenly spaced. Places run from 0 at the left or upper edge of the image to 65535 at the other,
/// the logarithm of the target over its range, features from 1 with 0 for none. Fails with InvalidConfig where the file
/// is not what `traces` says.
std::optional<ChainData> readChainData(const std::filesystem::path& folder, const Json& result, int most);

}  // namespace ulam
