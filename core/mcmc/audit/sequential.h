#pragma once
// The sequential rule of Gandy & Scott 2020 ("Unit testing for MCMC and other Monte Carlo methods", Algorithm 3): the
// only allowed retry of a statistical test. It rejects a true hypothesis with a probability of at most `level`, and
// goes on with fresh samples while the evidence is in between.

#include <cmath>
#include <functional>

namespace ulam::audit {

inline constexpr int kMostRounds = 4;
inline constexpr double kGrowth = 4;  ///< more samples from the second round on

struct SequentialResult {
    bool rejected = false;
    int rounds = 0;
    double p = 1;  ///< of the last round
};

/// `test(round, size)` gives a p-value from fresh samples, `size` times as many as the first round has.
inline SequentialResult sequentialTest(double level, const std::function<double(int round, double size)>& test) {
    double beta = level / kMostRounds;
    const double gamma = std::pow(beta, 1.0 / kMostRounds);
    SequentialResult result;
    for (; result.rounds < kMostRounds; beta /= gamma) {
        result.p = test(result.rounds, result.rounds == 0 ? 1 : kGrowth);
        ++result.rounds;
        if (result.p <= beta) return result.rejected = true, result;
        if (result.p > gamma + beta) return result;
    }
    return result;
}

}  // namespace ulam::audit
