#include "experiments/statistics/features.h"

#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

namespace {

/// Occupancy of equal holes by chains that never change hole; `favoured` makes the first hole more likely.
std::vector<std::vector<double>> trappedChains(std::size_t replicates, std::size_t holes, int chains, double favoured,
                                               PhiloxStream& random) {
    std::vector<double> weights(holes, 1.0);
    weights[0] = favoured;
    std::discrete_distribution<std::size_t> hole(weights.begin(), weights.end());
    std::vector<std::vector<double>> shares(replicates, std::vector<double>(holes));
    for (std::vector<double>& replicate : shares) {
        for (int i = 0; i < chains; ++i) replicate[hole(random)] += 1.0 / chains;
    }
    return shares;
}

double smallestAdjusted(std::span<const FeatureShare> features) {
    double smallest = 1;
    for (const FeatureShare& f : features) smallest = std::min(smallest, f.pAdjusted);
    return smallest;
}

}  // namespace

TEST_CASE("shares and intervals are means and t-intervals over replicates") {
    const std::vector<std::vector<double>> shares{{0.2, 0.8}, {0.3, 0.7}, {0.4, 0.6}};
    const std::vector<FeatureShare> features = featureShares(shares, {});
    REQUIRE(features.size() == 2);
    CHECK(features[0].share == Approx(0.3));
    CHECK(features[0].ci95->low == Approx(0.3 - 4.302653 * 0.1 / std::sqrt(3.0)));
    CHECK(features[1].ci95->high == Approx(0.7 + 4.302653 * 0.1 / std::sqrt(3.0)));
    CHECK_FALSE(features[0].truth);
    CHECK(features[0].p == 1);
}

TEST_CASE("intervals stay within 0 and 1") {
    const std::vector<FeatureShare> features = featureShares(std::vector<std::vector<double>>{{0, 1}, {0.1, 0.9}}, {});
    CHECK(features[0].ci95->low == 0);
    CHECK(features[1].ci95->high == 1);
}

TEST_CASE("64 right shares raise a false alarm in 5 % of experiments") {
    const std::vector<MeanEstimate> truth(64, MeanEstimate{1.0 / 64});
    const double falseAlarms = frequency(1000, 91, [&](PhiloxStream& random) {
        return smallestAdjusted(featureShares(trappedChains(8, 64, 1000, 1, random), truth)) <= 0.05;
    });
    CHECK(falseAlarms <= 0.065);  // standard error 0.7 %
    CHECK(falseAlarms >= 0.02);
}

TEST_CASE("few trapped chains scatter: false alarms stay rare, and what cannot be judged is not") {
    const std::vector<MeanEstimate> truth(64, MeanEstimate{1.0 / 64});
    int judged = 0;
    const auto falseAlarms = [&](std::size_t replicates, int chains, std::uint64_t seed) {
        judged = 0;
        return frequency(1000, seed, [&](PhiloxStream& random) {
            const auto features = featureShares(trappedChains(replicates, 64, chains, 1, random), truth);
            for (const FeatureShare& f : features) judged += f.judged;
            return smallestAdjusted(features) <= 0.05;
        });
    };
    CHECK(falseAlarms(8, 60, 94) <= 0.065);  // the relative spread of a hole's share is about 1
    CHECK(judged < 64 * 1000 / 10);
    CHECK(falseAlarms(16, 250, 95) <= 0.065);  // about 1/2
    CHECK(falseAlarms(64, 60, 96) <= 0.065);
    CHECK(judged > 64 * 1000 / 3);
}

TEST_CASE("a hole of twice its share is found among 64") {
    const std::vector<MeanEstimate> truth(64, MeanEstimate{1.0 / 64});
    const double found = frequency(300, 92, [&](PhiloxStream& random) {
        return featureShares(trappedChains(8, 64, 1000, 2, random), truth)[0].pAdjusted <= 0.05;
    });
    CHECK(found >= 0.9);
}

TEST_CASE("a reference's own variance counts") {
    const double falseAlarms = frequency(1000, 93, [&](PhiloxStream& random) {
        const std::vector<std::vector<double>> reference = trappedChains(8, 16, 1000, 1, random);
        std::vector<MeanEstimate> truth;
        for (std::size_t f = 0; f < 16; ++f) {
            std::vector<double> column;
            for (const std::vector<double>& r : reference) column.push_back(r[f]);
            truth.push_back(estimateMean(column));
        }
        return smallestAdjusted(featureShares(trappedChains(8, 16, 1000, 1, random), truth)) <= 0.05;
    });
    CHECK(falseAlarms <= 0.065);
    CHECK(falseAlarms >= 0.02);
}

TEST_CASE("a feature that is never visited is judged by how improbable that is") {
    const std::vector<std::vector<double>> shares(8, {0.0, 1.0});
    const std::vector<FeatureShare> rare = featureShares(shares, std::vector<MeanEstimate>{{1e-6}, {1 - 1e-6}});
    CHECK(rare[0].p == 1);
    const std::vector<FeatureShare> large = featureShares(shares, std::vector<MeanEstimate>{{0.5}, {0.5}});
    CHECK(large[0].p == Approx(2 * std::pow(0.5, 8)));
    CHECK(featureShares(shares, std::vector<MeanEstimate>{{0.0}, {1.0}})[0].p == 1);
}

TEST_CASE("lengths that differ are refused and one replicate is not judged") {
    const std::vector<std::vector<double>> one{{0.5, 0.5}};
    const std::vector<MeanEstimate> truth{{0.1}, {0.9}};
    CHECK(featureShares(one, truth)[0].p == 1);
    CHECK_FALSE(featureShares(one, truth)[0].ci95);
    CHECK_THROWS_AS(featureShares(one, std::vector<MeanEstimate>{{1.0}}), ulam::Error);
    CHECK_THROWS_AS(featureShares(std::vector<std::vector<double>>{{1, 2}, {1}}, {}), ulam::Error);
}
