#pragma once
// Tokens that name one sample or step of one run, for `ulam replay-path`: everything that is needed to make it again.

#include "core/render/non_finite_log.h"
#include "experiments/engine/result.h"

namespace ulam {

/// Of a run whose work is known, as a word of letters, digits, '-' and '_'.
std::string pathToken(const RunIdentity& run, const Json& repeat, const NonFiniteEvent& event);

struct PathToken {
    Json repeat;  ///< scene, sampler and budget as in result.json
    std::string sceneHash;
    RandomKey key;
    NonFiniteEvent event;
};
/// Fails with Usage where the word is no token or a damaged one.
PathToken readPathToken(const std::string& token);

}  // namespace ulam
