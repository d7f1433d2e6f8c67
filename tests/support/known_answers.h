#pragma once
// Independent runs of a sampler against an image that is known.

#include <vector>

#include "core/render/driver.h"
#include "core/scene/load.h"
#include "tests/support/catch.h"

namespace ulam {

/// Names of all registered samplers.
std::vector<std::string> samplerNames();
bool isChainSampler(const std::string& name);

/// `runs` complete runs with seeds of their own.
std::vector<RenderResult> renderRuns(const Scene& scene, const Json& sampler, const Budget& budget, int runs,
                                     uint64_t seed);

/// Means of independent runs against a known value.
struct Deviation {
    double mean = 0, standardError = 0, p = 1;  ///< p: two-sided t
};
Deviation deviation(const std::vector<double>& values, double truth);

/// Luminance of each of tiles × tiles parts of an image, relative to the whole's mean; row by row.
std::vector<double> tileMeans(const Image& image, int tiles);

/// What the comparisons of a test case find; Šidák at 1e-6 over all of them.
class Verdict {
public:
    void add(const Deviation& d, double truth, const std::string& what);
    void check() const;

private:
    int count_ = 0;
    double smallest_ = 1;
    std::string worst_;
};

}  // namespace ulam
