// Chains that were made up, of which the answers are known. A turn is ChainRun::kChunk mutations.

#include "experiments/engine/mixing.h"

#include <functional>
#include <numeric>

#include "core/render/chain_run.h"
#include "experiments/statistics/chains.h"
#include "experiments/statistics/moments.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam;
using statistics::PhiloxStream;
using statistics::Trace;
using statistics::simulation::normals;

namespace {

constexpr double kTurn = ChainRun::kChunk;
constexpr int kChains = 100;
constexpr std::size_t kTurns = 200;  ///< fewer than a trace keeps: each is a draw
constexpr double kSeconds = 4;

/// A chain that stays at one place of the image; a label a turn, or none.
ChainTrace traceOf(const Vec2f& origin, const Trace& logTargets, const std::vector<uint32_t>& labels = {}) {
    Sample x;
    x.splats.add({origin, Spectrum(1)});
    ChainTrace trace;
    trace.start(x);
    for (std::size_t turn = 0; turn < logTargets.size(); ++turn) {
        x.logTarget = logTargets[turn];
        trace.record(x, labels.empty() ? kNone : labels[turn]);
    }
    return trace;
}

/// Mean 0, variance 1 and correlation ρ^t after t turns, so that the time is (1 + ρ) / (1 − ρ) turns.
Trace correlated(std::size_t turns, double rho, PhiloxStream& random) {
    Trace values = normals(turns, random);
    for (std::size_t t = 1; t < turns; ++t) values[t] = rho * values[t - 1] + std::sqrt(1 - rho * rho) * values[t];
    return values;
}

/// What is found of log_target where chains start anywhere.
Json mixingOfCorrelated(int chains, std::size_t turns, double rho) {
    PhiloxStream random(211);
    std::vector<ChainTrace> traces;
    for (int c = 0; c < chains; ++c) {
        const Vec2f origin(float(random.index(256)), float(random.index(256)));
        traces.push_back(traceOf(origin, correlated(turns, rho, random)));
    }
    return mixing(traces, kSeconds, 1);
}

/// Somewhere in one of the four quarters of an image of 256 × 256 pixels, in the order of the Z-curve.
Vec2f inQuarter(int quarter, PhiloxStream& random) {
    return {float(128 * (quarter % 2)) + float(random.index(128)), float(128 * (quarter / 2)) + float(random.index(128))};
}

/// A chain around each of the means, started in its quarter.
Json mixingOfGroups(const std::vector<int>& quarters, const std::vector<double>& means) {
    PhiloxStream random(212);
    std::vector<ChainTrace> traces;
    for (std::size_t c = 0; c < means.size(); ++c) {
        Trace values = normals(kTurns, random);
        for (double& x : values) x += means[c];
        traces.push_back(traceOf(inQuarter(quarters[c], random), values));
    }
    return mixing(traces, kSeconds, 1).at("log_target");
}

/// Of the labels of chains that ask for one every turn.
Json mixingOfLabels(const std::function<uint32_t(int chain)>& label) {
    PhiloxStream random(213);
    std::vector<ChainTrace> traces;
    for (int c = 0; c < kChains; ++c) {
        std::vector<uint32_t> labels(kTurns);
        std::ranges::generate(labels, [&] { return label(c); });
        traces.push_back(traceOf({float(c), 0}, normals(kTurns, random), labels));
    }
    return mixing(traces, kSeconds, 1).at("feature");
}

}  // namespace

// The time found scatters by 2 % in 100 chains of 200 independent draws each and is 1.5 % too long, as simulated with other
// seeds; of AR(1) whose time is 4.6 draws by 6 %.

TEST_CASE("of independent draws each counts, and their time is at most that from one to the next") {
    const Json found = mixingOfCorrelated(kChains, kTurns, 0);
    CHECK(found.at("draws_per_chain") == kTurns);
    CHECK(found.at("mutations_per_draw") == kTurn);
    const Json& scalar = found.at("log_target");
    const double draws = kChains * double(kTurns);
    CHECK(scalar.at("ess").get<double>() == Approx(draws).epsilon(0.1));
    CHECK(scalar.at("ess_per_second").get<double>() == Approx(scalar.at("ess").get<double>() / kSeconds));
    CHECK(scalar.at("integrated_autocorrelation_mutations").get<double>() == Approx(kTurn).epsilon(0.1));
    CHECK(scalar.at("integrated_autocorrelation_bound") == "upper");
    CHECK(scalar.at("split_rhat").get<double>() < 1.01);
    // √(1 + 1 / 10) if each trace were one draw long.
    CHECK(scalar.at("nested_rhat").get<double>() < 1.01);
    CHECK(scalar.at("nested_rhat").get<double>() >= 1);
    CHECK_FALSE(found.contains("path_length"));  // which is the same everywhere
}

TEST_CASE("the autocorrelation time of AR(1) is found in mutations, whatever the stride of the draws") {
    const double rho = 0.8, turns = (1 + rho) / (1 - rho);
    SECTION("every turn") {
        const Json found = mixingOfCorrelated(kChains, kTurns, rho);
        const Json& scalar = found.at("log_target");
        CHECK(scalar.at("integrated_autocorrelation_mutations").get<double>() == Approx(turns * kTurn).epsilon(0.25));
        CHECK(scalar.at("ess").get<double>() == Approx(kChains * double(kTurns) / turns).epsilon(0.25));
        CHECK(scalar.at("integrated_autocorrelation_bound").is_null());
        CHECK(scalar.at("split_rhat").get<double>() < 1.05);
    }
    SECTION("every second turn") {
        const Json found = mixingOfCorrelated(kChains, 2 * kTurns, rho);
        CHECK(found.at("mutations_per_draw") == 2 * kTurn);
        const Json& scalar = found.at("log_target");
        CHECK(scalar.at("integrated_autocorrelation_mutations").get<double>() == Approx(turns * kTurn).epsilon(0.25));
        CHECK(scalar.at("integrated_autocorrelation_bound").is_null());
    }
}

TEST_CASE("thinning hides a time that is shorter than the stride, and the result says so") {
    const Json found = mixingOfCorrelated(kChains, 32 * kTurns, 0.8);  // 9 turns
    CHECK(found.at("draws_per_chain") == kTurns);
    CHECK(found.at("mutations_per_draw") == 32 * kTurn);
    const Json& scalar = found.at("log_target");
    CHECK(scalar.at("integrated_autocorrelation_mutations").get<double>() == Approx(32 * kTurn).epsilon(0.1));
    CHECK(scalar.at("integrated_autocorrelation_bound") == "upper");
}

TEST_CASE("a time longer than the traces is a lower bound") {
    const Json scalar = mixingOfCorrelated(kChains, kTurns, 0.999).at("log_target");  // 1999 turns
    CHECK(scalar.at("integrated_autocorrelation_mutations").get<double>() > double(kTurns) * kTurn);
    CHECK(scalar.at("integrated_autocorrelation_mutations").get<double>() < 1999 * kTurn);
    CHECK(scalar.at("integrated_autocorrelation_bound") == "lower");
    CHECK(scalar.at("split_rhat").get<double>() > 1.1);
}

TEST_CASE("chains that are caught by a few features are worth less than a draw each") {
    PhiloxStream random(214);
    // Eight of 64 holes; one turn in a hundred is spent in any of these.
    const Json caught = mixingOfLabels([&](int c) { return random.index(100) == 0 ? uint32_t(random.index(8)) : uint32_t(c % 8); });
    CHECK(caught.at("split_rhat").get<double>() > 2);
    CHECK(caught.at("ess").get<double>() < kChains);
    CHECK(caught.at("integrated_autocorrelation_bound") == "lower");
    const Json free = mixingOfLabels([&](int) { return uint32_t(random.index(64)); });
    CHECK(free.at("split_rhat").get<double>() < 1.01);
    CHECK(free.at("ess").get<double>() > 0.9 * kChains * double(kTurns));
}

TEST_CASE("chains that stand still in different features have no finite R-hat and half a draw each") {
    const Json still = mixingOfLabels([](int c) { return uint32_t(c % 8); });
    CHECK(still.at("split_rhat").is_null());
    // All correlations are 1: τ = 2n − 1.
    CHECK(still.at("integrated_autocorrelation_mutations").get<double>() == Approx((2 * double(kTurns) - 1) * kTurn));
    CHECK(still.at("ess").get<double>() == Approx(kChains * double(kTurns) / (2 * double(kTurns) - 1)));
    CHECK(still.at("integrated_autocorrelation_bound") == "lower");
}

TEST_CASE("the groups of nested R-hat are ten chains that started next to each other on the image") {
    constexpr int kPerQuarter = 10, kCount = 4 * kPerQuarter;
    std::vector<int> quarters(kCount), shared(kCount);
    std::vector<double> means(kCount);
    for (int c = 0; c < kCount; ++c) {
        quarters[std::size_t(c)] = c % 4;
        shared[std::size_t(c)] = c / kPerQuarter;
        means[std::size_t(c)] = c % 4;
    }
    // A quarter of the image has one mean: B is the variance of 0, 1, 2, 3 and W that of the draws, 1, and of the chains' means.
    const Json apart = mixingOfGroups(quarters, means);
    CHECK(apart.at("nested_rhat").get<double>() == Approx(std::sqrt(1 + 5.0 / 3)).epsilon(0.05));
    // Every quarter has all means: groups are alike, though their chains are not. Their means are 1.3 or 1.7: B = 0.053, W = 2.3.
    const Json alike = mixingOfGroups(shared, means);
    CHECK(alike.at("nested_rhat").get<double>() < 1.02);
    CHECK(alike.at("split_rhat").get<double>() == Approx(apart.at("split_rhat").get<double>()));
    CHECK(alike.at("split_rhat").get<double>() > 1.2);
}

TEST_CASE("chains beyond the last ten are in no group, and one group alone is compared with none") {
    // 20 chains in the first quarter, then five in the last, far from all others.
    std::vector<int> quarters(25, 0);
    std::vector<double> means(25, 0);
    std::fill(quarters.end() - 5, quarters.end(), 3);
    std::fill(means.end() - 5, means.end(), 100.0);
    const Json found = mixingOfGroups(quarters, means);
    CHECK(found.at("nested_rhat").get<double>() < 1.01);
    CHECK(found.at("split_rhat").get<double>() > 1.2);
    CHECK(mixingOfCorrelated(19, kTurns, 0).at("log_target").at("nested_rhat").is_null());
    CHECK(mixingOfCorrelated(20, kTurns, 0).at("log_target").at("nested_rhat").is_number());
}

TEST_CASE("chains of which one has had a turn more are compared at the same turns") {
    PhiloxStream random(215);
    const auto turns = [&](std::size_t n) { return traceOf({0, 0}, normals(n, random)); };
    const Json found = mixing({turns(ChainTrace::kMost - 1), turns(ChainTrace::kMost)}, kSeconds, 1);
    CHECK(found.at("draws_per_chain") == ChainTrace::kMost / 2);
    CHECK(found.at("mutations_per_draw") == 2 * kTurn);
}

TEST_CASE("traces of fewer than eight draws say nothing") {
    CHECK(mixingOfCorrelated(20, 7, 0).is_null());
    CHECK(mixingOfCorrelated(20, 8, 0).at("draws_per_chain") == 8);
    CHECK(mixing({}, kSeconds, 1).is_null());
}
