#pragma once
// How much the audit does, and what its parts share.

#include <chrono>
#include <functional>
#include <map>
#include <string_view>

#include "experiments/verify/image_audit.h"
#include "experiments/verify/report.h"

namespace ulam::verify {

/// Šidák's level of all tests of one level over a suite.
inline constexpr double kSuiteLevel = 1e-6;

struct Work {
    uint64_t seedSamples;                   ///< bootstrap samples that states are looked for in, each scene
    size_t states;                          ///< kept of them
    uint64_t structure, balance, jacobian;  ///< trials of L0 and L1, each scene
    size_t densityStates;  ///< of L2, each scene
    uint64_t density;      ///< proposals from each of them, and independent ones
    uint64_t starts;  ///< bootstrap samples of the weighted identities, each scene and mix; a tenth of it where a step
                      ///< is a whole sample
    uint64_t ranks;   ///< chains of the rank test
    int runs;         ///< of L5
    double bootstrap, pathMutations, primaryMutations, samplesPerPixel;  ///< each run
    double energyWidth;                                 ///< largest half width of the energy interval, relative
    std::vector<std::string> aloneImages, mixedImages;  ///< scenes of L5 and L6
    size_t partners;                                    ///< of L6
    int mixingChains;                                   ///< of L7
    double mixingSteps;                                 ///< of each
};
Work quickWork();
Work fullWork();

struct AuditSettings {
    Work work;
    uint64_t seed;
    int threads;
    size_t subjects;           ///< that share the suite's level
    bool stopAtFirst = false;  ///< leaves out what comes after a subject's first rejection
    /// Share of the subject's work that is done, and what comes next.
    std::function<void(double done, const std::string& what)> progress = [](double, const std::string&) {};
};

/// The finding of a check, with the time it took.
template <class Check>
Finding timed(const Check& check) {
    const auto start = std::chrono::steady_clock::now();
    Finding finding = check();
    finding.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return finding;
}

/// Chooses the random numbers of a part of the audit by its name.
uint64_t cellOf(std::string_view name);

/// Makes runs of `factor` times the work; `part` chooses their random numbers.
using MakeRuns = std::function<TiledEstimate(double factor, int runs, const char* part)>;
/// Runs that make the energy interval narrow enough: a pilot says how much work that takes, since scenes and samplers
/// differ widely in variance. Runs that say themselves that they are biased are returned as they are.
TiledEstimate preciseRuns(const Work& work, const MakeRuns& make, double leastFactor, double mostFactor);
// How small a factor may get, with which the pilot is made, and how large one of a sampler.
inline constexpr double kPilotShare = 0.05, kMostGrowth = 400;

/// Images by bidirectional path tracing, made when they are asked for first; precise enough for the energy interval.
class References {
public:
    References(const Work& work, uint64_t seed, int threads) : work_(work), seed_(seed), threads_(threads) {}
    const TiledEstimate& operator()(const audit::AuditScene& scene);

private:
    Work work_;
    uint64_t seed_;
    int threads_;
    std::map<std::string, TiledEstimate> made_;
};

/// Parameters that every sampler shares: how long the audit scenes' paths get.
Json samplerConfig(const std::string& sampler, const audit::AuditScene& scene);

/// The finding of one subject's comparisons: Holm over all tiles, and every energy interval.
Finding judgeImages(const std::vector<ImageComparison>& comparisons, const Work& work);

}  // namespace ulam::verify
