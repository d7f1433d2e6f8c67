#pragma once
// What the audit found, for people and as JSON.

#include <optional>
#include <string>
#include <vector>

#include "core/config/json.h"

namespace ulam::verify {

enum class Outcome : uint8_t {
    Passed,
    Rejected,
    NotAudited,  ///< the subject lacks what the level needs; said, never passed in silence
    Reported,    ///< measured, not judged
    NotCovered,  ///< no audit scene lets the subject work: a failure of the audit
};
const char* name(Outcome outcome);

/// One level of the audit of one mutation or sampler.
struct Finding {
    std::string level, check;
    Outcome outcome = Outcome::Passed;
    std::string summary = {};               ///< one line
    std::vector<std::string> details = {};  ///< what failed and what could not be judged, in words
    /// Statistic, p-value where there is one, and sample size of the level's verdict.
    std::optional<double> statistic = {}, p = {};
    uint64_t samples = 0;
    Json numbers = Json::object();
    double seconds = 0;
};

struct SubjectReport {
    std::string kind, name;   ///< "mutation", "sampler", "kernel" or "target"
    std::string replay = {};  ///< the command that repeats this audit
    std::vector<Finding> findings = {};
    bool rejected() const;
};

struct Report {
    uint64_t seed = 0;
    std::string level;
    std::vector<SubjectReport> subjects = {};
    bool rejected() const;
};

void print(const SubjectReport& report);
Json toJson(const Report& report);

}  // namespace ulam::verify
