#include "experiments/statistics/chains.h"

#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "experiments/statistics/moments.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

namespace {

/// Stationary, variance 1, autocorrelation ρ^t, therefore τ = (1 + ρ) / (1 - ρ).
Trace autoregressive(std::size_t n, double rho, PhiloxStream& random) {
    Trace trace = normals(n, random);
    for (std::size_t i = 1; i < n; ++i) trace[i] = rho * trace[i - 1] + std::sqrt(1 - rho * rho) * trace[i];
    return trace;
}

double effectiveSamples(const std::vector<Trace>& chains) {
    return static_cast<double>(chains.size() * chains[0].size()) / autocorrelationTime(chains);
}

std::vector<Trace> independent(std::size_t chains, std::size_t n, PhiloxStream& random) {
    std::vector<Trace> traces;
    for (std::size_t i = 0; i < chains; ++i) traces.push_back(normals(n, random));
    return traces;
}

}  // namespace

TEST_CASE("the autocorrelation time of AR(1) is (1 + rho) / (1 - rho)") {
    const double rho = GENERATE(-0.5, 0.0, 0.5, 0.9, 0.98);
    const double tau = (1 + rho) / (1 - rho);
    CAPTURE(rho);
    PhiloxStream random(111);
    std::vector<double> estimates;
    for (int i = 0; i < 20; ++i)
        estimates.push_back(autocorrelationTime(std::vector<Trace>{autoregressive(20'000, rho, random)}));
    CHECK(mean(estimates) == Approx(tau).epsilon(0.06));
}

TEST_CASE("the effective sample size predicts the variance of a mean") {
    PhiloxStream random(112);
    std::vector<double> means;
    std::vector<double> sizes;
    for (int i = 0; i < 1000; ++i) {
        const std::vector<Trace> chains{autoregressive(1000, 0.8, random), autoregressive(1000, 0.8, random)};
        means.push_back((mean(chains[0]) + mean(chains[1])) / 2);
        sizes.push_back(effectiveSamples(chains));
    }
    CHECK(mean(sizes) == Approx(1 / variance(means)).epsilon(0.15));  // standard error of the variance 4.5 %
}

TEST_CASE("chains that disagree are worth few samples") {
    PhiloxStream random(113);
    std::vector<Trace> chains = independent(4, 1000, random);
    CHECK(effectiveSamples(chains) > 3000);
    for (double& x : chains[0]) x += 10;
    CHECK(effectiveSamples(chains) < 10);
}

TEST_CASE("a trace that never moves is one sample") {
    CHECK(autocorrelationTime(std::vector<Trace>{Trace(100, 3.0)}) == 100);
    CHECK_THROWS_AS(autocorrelationTime(std::vector<Trace>{{1, 2, 3}}), ulam::Error);
}

TEST_CASE("split R-hat is near 1 for independent chains, whatever their distribution") {
    PhiloxStream random(114);
    for (int i = 0; i < 50; ++i) {
        std::vector<Trace> chains = independent(4, 1000, random);
        CHECK(splitRhat(chains) < 1.01);
        CHECK(splitRhat(chains) > 0.999);
        const double before = splitRhat(chains);
        // Cauchy tails have no variance; ranks do not mind. The bulk part is the same for any increasing map.
        for (Trace& chain : chains) {
            for (double& x : chain) x = std::copysign(std::expm1(std::abs(x) * 5), x);
        }
        CHECK(splitRhat(chains) == Approx(before).epsilon(0.001));
    }
}

TEST_CASE("split R-hat sees shifted, differently spread and drifting chains") {
    PhiloxStream random(115);
    std::vector<Trace> shifted = independent(4, 1000, random);
    for (double& x : shifted[0]) x += 3;
    CHECK(splitRhat(shifted) > 1.3);
    std::vector<Trace> spread = independent(4, 1000, random);
    for (double& x : spread[0]) x *= 5;
    CHECK(splitRhat(spread) > 1.05);
    std::vector<Trace> drifting = independent(1, 1000, random);
    for (std::size_t i = 500; i < 1000; ++i) drifting[0][i] += 3;
    CHECK(splitRhat(drifting) > 1.3);
}

TEST_CASE("split R-hat of labels does not depend on their direction") {
    // Ties at their average rank are symmetric, at any other they are not.
    PhiloxStream random(117);
    std::vector<Trace> labels(4, Trace(200));
    for (std::size_t c = 0; c < labels.size(); ++c) {
        for (double& x : labels[c]) x = std::min<double>(2, static_cast<double>(random.index(c + 2)));
    }
    const double forward = splitRhat(labels);
    for (Trace& trace : labels) {
        for (double& x : trace) x = -x;
    }
    CHECK(splitRhat(labels) == Approx(forward).epsilon(1e-9));
    CHECK(forward > 1.05);
}

TEST_CASE("R-hat of chains that stand still") {
    const Trace zero(10, 0.0);
    const Trace one(10, 1.0);
    CHECK(splitRhat(std::vector<Trace>{zero, one}) == std::numeric_limits<double>::infinity());
    CHECK(splitRhat(std::vector<Trace>{one, one}) == 1);
    std::vector<Trace> many;  // whose means are rounded
    for (int i = 0; i < 100; ++i) many.emplace_back(200, i % 8);
    CHECK(splitRhat(many) == std::numeric_limits<double>::infinity());
    CHECK(nestedRhat(std::vector<Trace>{zero, zero, one, one}, 2) == std::numeric_limits<double>::infinity());
}

TEST_CASE("nested R-hat matches hand calculation") {
    // Super-chain means 2 and 4: B = 2. Inside: variances of means 2 and 2, of draws 2 each: W = 4.
    const std::vector<Trace> chains{{0, 2}, {2, 4}, {2, 4}, {4, 6}};
    CHECK(nestedRhat(chains, 2) == Approx(std::sqrt(1.5)));
    // Traces of length one: W is the variance between the chains alone.
    CHECK(nestedRhat(std::vector<Trace>{{1}, {3}, {3}, {5}}, 2) == Approx(std::sqrt(2.0)));
}

TEST_CASE("nested R-hat is near 1 for many short independent chains and large for trapped super-chains") {
    PhiloxStream random(116);
    // √(1 + 1 / (chains per super-chain × length)) in expectation.
    std::vector<Trace> chains = independent(64, 10, random);
    CHECK(nestedRhat(chains, 16) < 1.01);
    CHECK(nestedRhat(chains, 16) >= 1);
    for (std::size_t i = 0; i < 16; ++i) {
        for (double& x : chains[i]) x += 4;
    }
    CHECK(nestedRhat(chains, 16) > 1.5);
}

TEST_CASE("diagnostics refuse traces that do not fit together") {
    CHECK_THROWS_AS(splitRhat({}), ulam::Error);
    CHECK_THROWS_AS(splitRhat(std::vector<Trace>{{1, 2, 3, 4}, {1, 2, 3}}), ulam::Error);
    CHECK_THROWS_AS(nestedRhat(std::vector<Trace>(5, Trace{1, 2}), 2), ulam::Error);
    CHECK_THROWS_AS(nestedRhat(std::vector<Trace>(2, Trace{1, 2}), 2), ulam::Error);
    CHECK_THROWS_AS(nestedRhat(std::vector<Trace>(2, Trace{1}), 1), ulam::Error);
}
