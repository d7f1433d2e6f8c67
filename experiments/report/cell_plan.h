#pragma once
// Which files of a run a cell shows in its report.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/config/json.h"

namespace ulam {

/// What a cell shows, before its images are read.
struct CellPlan {
    std::string cell;
    std::map<std::size_t, std::filesystem::path> replicates;  ///< folders
    std::size_t median = 0, worst = 0;
    std::optional<std::filesystem::path> reference;
    std::vector<std::pair<int, int>> techniques;  ///< (s, t) with images in the median replicate's extra/
    Json result;                                  ///< the median replicate's result.json

    /// Of the median replicate, where there are replicates.
    std::filesystem::path folder() const { return replicates.at(median); }
    /// Its sampler is of Markov chains.
    bool hasChains() const { return result.is_object() && result.value("chains", 0.0) > 0; }
    /// The median replicate kept its chains.
    bool hasTraces() const { return result.is_object() && result.value("traces", Json()).is_object(); }
};

/// Null where there is no such file.
Json readJsonIfThere(const std::filesystem::path& path);

/// The folders of a cell's replicates that left an image, by number.
std::map<std::size_t, std::filesystem::path> replicateFolders(const std::filesystem::path& cellFolder);

/// Of a cell of summary.json, whose primary metric tells which replicates are the median and the worst where it does
/// not say.
CellPlan planCell(const std::filesystem::path& runDir, const Json& cell, const std::string& metric);

/// The image of a technique (s, t); `kind` is "weighted" or "unweighted".
std::filesystem::path techniqueFile(const std::filesystem::path& replicate, std::pair<int, int> technique,
                                    std::string_view kind);

}  // namespace ulam
