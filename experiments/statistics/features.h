#pragma once
// Occupancy of a scene's features (holes of a grid, a door gap): the share of a run's mutations, or of its weight,
// spent in each. Wrong shares show trapping that a noise-free image hides.

#include <optional>
#include <span>
#include <vector>

#include "experiments/statistics/intervals.h"
#include "experiments/statistics/welch.h"

namespace ulam::statistics {

struct FeatureShare {
    double share = 0;              // mean over replicates
    std::optional<Interval> ci95;  // Student's t over replicates, cut to [0, 1]; nothing below two
    std::optional<double> truth;
    double p = 1;          // share equals truth; 1 without truth or where it cannot be judged
    double pAdjusted = 1;  // Holm over the features
    bool judged = false;   // enough replicates for how much the share scatters
};

/// From this many replicates on, 64 features of a correct sampler raise an alarm in at most 6.5 % of experiments if chains
/// stay in one hole each (the tests simulate it), and in 7.3 % if shares are gamma-distributed with a spread of 1/2.
inline constexpr double kReplicatesPerSquaredSpread = 64;

/// p of equal means for replicates that are non-negative and skewed, against a truth with its own variance; nothing where
/// they scatter too much to be judged.
///
/// Chains that get caught give such replicates: most runs hardly visit a place, a few stay there, and Student's t finds the
/// former too dark far too often. So where s/mean exceeds 0.3, p is the larger one of Welch's test and the same with
/// Johnson's (1978) correction of the mean for skewness, and below kReplicatesPerSquaredSpread · (s/mean)² replicates
/// nothing is judged.
std::optional<double> skewedMeanP(std::span<const double> replicates, const MeanEstimate& truth);

/// shares[replicate][feature]. `truth` is empty or has one entry per feature: exact (MeanEstimate{share}) or a
/// reference with its own variance. Throws where the lengths differ.
///
/// Each p is that of skewedMeanP. A feature that no replicate visited has no variance for a t-test. Its p is
/// min(1, 2 (1 − w)^R) for truth w and R replicates: a variable in [0, 1] with mean w vanishes with probability at most
/// 1 − w, and the two pays for having two tests. The w of a reference is lowered by two standard errors.
std::vector<FeatureShare> featureShares(std::span<const std::vector<double>> shares,
                                        std::span<const MeanEstimate> truth);

}  // namespace ulam::statistics
