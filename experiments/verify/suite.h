#pragma once
// The audit of everything that is registered: which scenes, which mixes, how much work.

#include <functional>

#include "experiments/verify/report.h"

namespace ulam::verify {

enum class Level : uint8_t { Quick, Full };

struct Options {
    std::vector<std::string> mutations = {}, samplers = {}, kernels = {}, targets = {};  ///< names; none: everything
    Level level = Level::Quick;
    uint64_t seed = 1;
    int threads = 1;
    bool stopAtFirst = false;  ///< a subject's audit ends with its first rejection
    std::function<void(double fraction, const std::string& what)> progress = [](double, const std::string&) {};
    std::function<void(const SubjectReport&)> finished = {};  ///< after each subject
};

/// L0 to L2 and L4 to L7 for mutations, L3 for kernels, L5 for samplers and targets. Fails with Usage at unknown names.
Report verify(const Options& options);

}  // namespace ulam::verify
