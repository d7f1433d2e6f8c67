#pragma once
// Which points of a sweep's grid are run: "where": [[path, comparison, value], …].

#include <string>
#include <vector>

#include "core/config/json.h"

namespace ulam {

/// Conditions, all of which a point must meet. A path leads into the experiment as the point changes it; a value is a
/// number, a text, true or false, {"path": another one}, or for "in" a list of values.
class SweepFilter {
public:
    /// None: every point passes. Fails with InvalidConfig.
    explicit SweepFilter(const std::optional<JsonNode>& where);

    bool empty() const { return conditions_.empty(); }
    /// Fails with InvalidConfig where a path leads nowhere or values of different kinds would be compared.
    bool passes(const Json& experiment) const;

private:
    std::vector<JsonNode> conditions_;
};

}  // namespace ulam
