#pragma once
// A sweep: values of keys of an experiment, and the grid they make.

#include <string>
#include <vector>

#include "core/config/json.h"

namespace ulam {

/// One key with one of its values.
struct SweepValue {
    std::string path;  ///< "samplers.mlt.chains"
    Json value;
    std::string label;       ///< "chains=100", fit for a folder's name
    std::string shortLabel;  ///< the same with fewer steps of the path, for where many labels make a long name
};

/// One point of the grid; empty for an experiment without a sweep.
using SweepPoint = std::vector<SweepValue>;

/// All points, the last key running fastest. A key's values: sweep_values.h. {"zip": {key: values, …}} pairs values,
/// equally many of each key. "where" leaves points out: sweep_filter.h. Fails with InvalidConfig, also at keys that
/// belong to the whole run, at keys that overwrite each other, and at equal points; `experiment` is what the paths lead
/// into.
std::vector<SweepPoint> expandSweep(const JsonNode& sweep, const JsonNode& experiment);

/// The last steps of a path, as many as tell it from all other `paths`: "mlt.chains".
std::string shortName(const std::string& path, const std::vector<std::string>& paths);

/// Does a value touch a cell of this scene and sampler? Keys of other scenes and samplers do not.
bool affects(const SweepValue& value, const std::string& scene, const std::string& sampler);

}  // namespace ulam
