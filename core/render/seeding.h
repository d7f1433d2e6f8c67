#pragma once
// How Markov chains are seeded: the bootstrap's random numbers, what its weights tell, how many of them there are, and
// where chains start (docs/seeding.md).

#include "core/base/kronecker.h"
#include "core/base/random.h"

#include <span>
#include <vector>

namespace ulam {

/// Random numbers of bootstrap samples. The numbers that decide most, the raster position and the light's first vertex
/// and direction (of path tracing: the first two scatterings), come from a point set that covers the cube evenly; every
/// single sample is uniform all the same. Samples take turns in kSets sets, which are shifted independently: their means
/// are independent too, and tell the error of the mean of all.
class BootstrapNumbers {
public:
    static constexpr int kSets = 16;

    BootstrapNumbers(RandomKey key, uint32_t stream);

    /// use(random) with the numbers of sample i.
    template <class Use>
    auto with(uint64_t i, Use&& use) const {
        std::array<Block, kBlocks> script;
        Random free(key_, stream_, i);
        for (Block& block : script) block = free.nextBlock();
        for (int k = 0; k < kDimensions; ++k) script[size_t(kPlace[k][0])][size_t(kPlace[k][1])] = sets_[i % kSets](i / kSets, k);
        Random random(key_, stream_, i, script);
        return use(random);
    }

private:
    static constexpr int kBlocks = 3, kDimensions = 7;
    /// Block and number in it.
    static constexpr int kPlace[kDimensions][2] = {{0, 0}, {0, 1}, {1, 0}, {1, 1}, {1, 2}, {2, 0}, {2, 1}};

    RandomKey key_;
    uint32_t stream_;
    std::array<KroneckerSequence<kDimensions>, kSets> sets_;
};

/// What the weights of bootstrap samples (of all from the first on) tell.
struct WeightMoments {
    WeightMoments() = default;
    explicit WeightMoments(std::span<const double> weights);

    uint64_t samples = 0;
    double mean = 0;           ///< b
    double standardError = 0;  ///< of the mean, from the scatter of the sets' means
    double effective = 0;      ///< number of equal weights that scatter as much: (Σw)² / Σw² (Kish 1965)
    /// Variance of the mean over what it were if samples were independent: below 1 where their evenness helps.
    double stratification = 1;

    template <class Archive>
    void archive(Archive& a) {
        a(samples, mean, standardError, effective, stratification);
    }
};

/// What seeding works with, costs as fractions of the budget.
struct SeedingTask {
    double sampleCost;    ///< of one bootstrap sample
    double mutationCost;  ///< of one mutation
    double pixels;        ///< that a splat's variance is spread over: pixels · (∫h²)² of the reconstruction filter h
    int chains;
};

/// How many bootstrap samples there are, and why.
///
/// *Error of the image.* N mutations leave in a pixel of mean brightness at least the relative variance of N independent
/// samples of the target, pixels / N; chains' correlation comes on top. So the expected relative error is at least
/// e = √(pixels / N), and b, whose error all pixels share, shall have a standard error below e / 10: a hundredth of the
/// mean squared error.
/// *Starts.* Chains that stay near their starts make an image of as many independent parts as there are different starts:
/// the bootstrap's effective number of samples shall be no less than the number of chains.
/// *Share.* At least kSmallestShare of the budget, since large regions, which average over pixels, see b's error alone; at
/// most kLargestShare, so that chains cost at least as much as their seeding.
struct SeedingPlan {
    SeedingPlan() = default;
    SeedingPlan(const WeightMoments& pilot, const SeedingTask& task);

    static constexpr double kScaleError = 0.1, kSmallestShare = 0.05, kLargestShare = 0.5;
    static constexpr double kFewest = 1000, kMost = 20'000'000;

    double expectedError = 0;    ///< e
    double samplesForScale = 0, samplesForStarts = 0, samplesForSmallestShare = 0, samplesForLargestShare = 0;
    uint64_t samples = 0;

    template <class Archive>
    void archive(Archive& a) {
        a(expectedError, samplesForScale, samplesForStarts, samplesForSmallestShare, samplesForLargestShare, samples);
    }
};

/// Where a chain starts: at a sample, and within it at the part in which the running sum of π passes `choice` of it.
struct Start {
    uint64_t sample;
    double choice;
};

/// Each of `count` starts is drawn by weight; all together are spread over the weights evenly (systematic resampling), and
/// their order tells nothing. There must be a positive weight.
std::vector<Start> drawStarts(std::span<const double> weights, size_t count, Random& random);

}  // namespace ulam
