#pragma once
// Tuning a sampler's parameters before it is compared ("tune"): successive halving (Jamieson and Talwalkar 2016,
// "Non-stochastic Best Arm Identification and Hyperparameter Optimization", section 3).

#include "experiments/engine/run.h"

namespace ulam {

/// The candidates of a checked experiment: points of tune's sweep, all of one sampler's parameters.
struct Tuning {
    std::string sampler;
    std::vector<SweepPoint> candidates;
    TuneParameters parameters;
};

/// Nothing where the experiment does not ask for it. Fails with InvalidConfig, naming the place. The experiment gets the
/// sampler as it is a second time, as SAMPLER_untuned, so that it can be compared with what tuning made of it.
std::optional<Tuning> plannedTuning(JsonDocument& experiment);

/// The rounds: each candidate that is left gets `fraction` of the experiment's budget. After a round the best
/// 1 / reduction go on; the budget grows as their number falls, so that each round costs about the same, and the last is at
/// the whole budget.
struct TuningRound {
    double fraction;
    std::size_t candidates;
};
std::vector<TuningRound> tuningRounds(const Tuning& tuning);

/// The experiment of a round: the candidates c0, c1, … by their numbers, with random numbers of its own, so that the runs
/// that judge the winner know nothing of those that chose it.
JsonDocument roundExperiment(const JsonDocument& experiment, const Tuning& tuning, std::size_t round,
                             const std::vector<std::size_t>& candidates);

struct TuningOutcome {
    bool interrupted = false;
    JsonDocument experiment;  ///< with the winner's values
    Json record;              ///< of candidates, rounds and scores: summary.json's "tuning"
};

/// Runs the rounds in RUN_DIR/tuning/ROUND, each a run of its own that is gone on with where it was interrupted. The score
/// of a candidate is the mean over the scenes of the log of its mean error. Fails with InvalidConfig where the reference
/// is too poor for that.
TuningOutcome tune(const JsonDocument& experiment, const std::filesystem::path& file, const Tuning& tuning,
                   const RunOptions& options, const std::atomic<bool>& interrupt, Progress& progress);

}  // namespace ulam
