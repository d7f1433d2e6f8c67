#pragma once
// Made-up replicates with known expectations, for tests of level and coverage.

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "experiments/statistics/philox_stream.h"

namespace ulam::statistics::simulation {

/// Expectation 1 whatever the standard deviation of the log.
inline std::vector<double> lognormalErrors(std::size_t n, double sigma, PhiloxStream& random) {
    std::lognormal_distribution<double> distribution(-sigma * sigma / 2, sigma);
    std::vector<double> errors(n);
    std::ranges::generate(errors, [&] { return distribution(random); });
    return errors;
}

inline std::vector<double> normals(std::size_t n, PhiloxStream& random) {
    std::normal_distribution<double> distribution;
    std::vector<double> values(n);
    std::ranges::generate(values, [&] { return distribution(random); });
    return values;
}

/// Share of trials for which `holds(random)` is true.
template <class Predicate>
double frequency(int trials, std::uint64_t seed, Predicate holds) {
    PhiloxStream random(seed);
    int count = 0;
    for (int i = 0; i < trials; ++i) count += holds(random) ? 1 : 0;
    return static_cast<double>(count) / trials;
}

}  // namespace ulam::statistics::simulation
