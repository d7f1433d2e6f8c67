#pragma once
// The audit of everything that is registered: which scenes, which mixes, how much work.

#include <functional>

#include "experiments/verify/report.h"

namespace ulam::verify {

enum class Level : uint8_t { Quick, Full };

struct Options {
    std::vector<std::string> mutations = {}, samplers = {};  ///< names; both empty: everything registered
    Level level = Level::Quick;
    uint64_t seed = 1;
    int threads = 1;
    bool stopAtFirst = false;  ///< a subject's audit ends with its first rejection
    std::function<void(double fraction, const std::string& what)> progress = {};
    std::function<void(const SubjectReport&)> finished = {};  ///< after each subject
};

/// L0, L1 and L4 (core/mcmc/audit) and L5 for mutations, L5 for samplers. Fails with Usage at unknown names.
Report verify(const Options& options);

}  // namespace ulam::verify
