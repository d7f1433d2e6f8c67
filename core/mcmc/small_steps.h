#pragma once
// What mutations of primary numbers share: each number moves on its own, on the unit circle.

#include "core/mcmc/sample.h"

namespace ulam {

/// x + delta, wrapped into (0, 1).
inline double wrapped(double x, double delta) {
    double y = x + delta;
    y -= std::floor(y);
    return y > 0 && y < 1 ? y : 0.5 * 0x1p-32;
}

/// The signed way from a to b around the circle, in [−1/2, 1/2).
inline double wrappedDifference(double a, double b) {
    const double d = b - a;
    return d - std::floor(d + 0.5);
}

/// Moves every number that x uses; y's further numbers, if it needs any, are drawn uniformly when they are used.
template <class Move>
void moveNumbers(const PrimaryVector& x, PrimaryVector& y, Random& random, Move&& move) {
    y = x;
    for (int s = 0; s < kStreams; ++s) {
        const auto stream = NumberStream(s);
        for (int i = 0; i < y.size(stream); ++i)
            for (double& u : y(stream, i)) u = move(u, random);
    }
}

/// Σ log of the density of each move, over the numbers both have.
template <class LogDensity>
double logMoves(const PrimaryVector& x, const PrimaryVector& y, LogDensity&& logDensity) {
    double sum = 0;
    for (int s = 0; s < kStreams; ++s) {
        const auto stream = NumberStream(s);
        for (int i = 0; i < std::min(x.size(stream), y.size(stream)); ++i)
            for (int j = 0; j < 4; ++j) sum += logDensity(wrappedDifference(x(stream, i)[size_t(j)], y(stream, i)[size_t(j)]));
    }
    return sum;
}

}  // namespace ulam
