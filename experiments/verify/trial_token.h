#pragma once
// Tokens of single trials of a mutation's audit, for `ulam replay-path`.

#include "experiments/verify/mutation_levels.h"

namespace ulam::verify {

inline constexpr std::string_view kTrialPrefix = "audit1-";

/// `check` is "structure", "balance", "jacobian", whose trials have numbers, or "density", whose states have.
std::string trialToken(const MutationCase& c, const Place& place, std::string_view check, uint64_t trial);

/// Makes the trial again: its failures, and the states and proposals as describeStep has them. Fails with Usage where the
/// token is damaged, or names what is not there (a plug-in that is not loaded).
Json replayTrial(const std::string& token);

}  // namespace ulam::verify
