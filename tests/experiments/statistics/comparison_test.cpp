#include "experiments/statistics/comparison.h"

#include <vector>

#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

namespace {

std::vector<double> scaled(std::vector<double> errors, double factor) {
    for (double& x : errors) x *= factor;
    return errors;
}

bool anyWinner(std::span<const Comparison> comparisons) {
    return std::ranges::any_of(comparisons, [](const Comparison& c) { return c.verdict != Verdict::Undecided; });
}

}  // namespace

TEST_CASE("a sampler against itself is named a winner in at most 6.5 % of 1000 experiments") {
    const double sigma = GENERATE(0.2, 0.5);
    CAPTURE(sigma);
    const double familyWise = frequency(1000, 41, [&](PhiloxStream& random) {
        const std::vector<double> baseline = lognormalErrors(8, sigma, random);
        std::vector<Comparison> comparisons;
        for (int i = 0; i < 4; ++i) comparisons.push_back(compare(lognormalErrors(8, sigma, random), baseline));
        decide(comparisons);
        return anyWinner(comparisons);
    });
    CHECK(familyWise <= 0.065);
    CHECK(familyWise >= 0.01);
}

TEST_CASE("equal mean errors of unequal spread name a winner in at most 7 % of experiments") {
    const std::size_t n = GENERATE(8, 16);
    const std::size_t m = 8;
    const int trials = n == 8 ? 4000 : 400;
    const double wrong = frequency(trials, 42, [&](PhiloxStream& random) {
        const std::vector<double> a = lognormalErrors(n, 0.5, random);
        std::vector<Comparison> one{compare(a, lognormalErrors(m, 0.2, random))};
        decide(one);
        return anyWinner(one);
    });
    CAPTURE(n, m);
    CHECK(wrong <= 0.07);
}

TEST_CASE("clear differences win in the right direction") {
    PhiloxStream random(43);
    const std::vector<double> baseline = lognormalErrors(8, 0.2, random);
    std::vector<Comparison> comparisons{compare(scaled(lognormalErrors(8, 0.2, random), 0.25), baseline),
                                        compare(scaled(lognormalErrors(8, 0.2, random), 4), baseline),
                                        compare(lognormalErrors(8, 0.2, random), baseline)};
    decide(comparisons);
    CHECK(comparisons[0].verdict == Verdict::Better);
    CHECK(comparisons[1].verdict == Verdict::Worse);
    CHECK(comparisons[2].verdict == Verdict::Undecided);
    CHECK(*comparisons[0].ratio == Approx(0.25).epsilon(0.3));
    CHECK(comparisons[0].ci95->low < *comparisons[0].ratio);
    CHECK(comparisons[0].ci95->high > *comparisons[0].ratio);
    CHECK(comparisons[0].p == Approx(2.0 / 12870));
    CHECK(comparisons[0].pAdjusted == Approx(6.0 / 12870));
}

TEST_CASE("too few replicates never win, however large the difference") {
    PhiloxStream random(44);
    std::vector<Comparison> comparisons{
        compare(scaled(lognormalErrors(3, 0.1, random), 0.01), lognormalErrors(3, 0.1, random))};
    decide(comparisons);
    CHECK(comparisons[0].pAdjusted == Approx(0.1));
    CHECK(comparisons[0].verdict == Verdict::Undecided);
    std::vector<Comparison> one{compare(std::vector<double>{1}, std::vector<double>{100})};
    decide(one);
    CHECK(*one[0].ratio == Approx(0.01));
    CHECK_FALSE(one[0].ci95);
    CHECK(one[0].verdict == Verdict::Undecided);
}

TEST_CASE("a winner alone can lose in a large family") {
    PhiloxStream random(45);
    const std::vector<double> baseline = lognormalErrors(5, 0.1, random);
    std::vector<Comparison> alone{compare(scaled(lognormalErrors(5, 0.1, random), 0.1), baseline)};
    std::vector<Comparison> family = alone;
    for (int i = 0; i < 9; ++i) family.push_back(compare(lognormalErrors(5, 0.1, random), baseline));
    decide(alone);
    decide(family);
    CHECK(alone[0].verdict == Verdict::Better);
    CHECK(family[0].pAdjusted == Approx(10 * alone[0].pAdjusted));
    CHECK(family[0].verdict == Verdict::Undecided);
}

TEST_CASE("a poor reference decides nothing") {
    PhiloxStream random(46);
    const std::vector<double> sampler = scaled(lognormalErrors(8, 0.1, random), 0.1);
    const std::vector<double> baseline = lognormalErrors(8, 0.1, random);
    std::vector<double> negative = sampler;
    negative[3] = -0.01;
    // A tenth of the smaller mean error, about 0.1, is allowed.
    std::vector<Comparison> comparisons{compare(sampler, baseline, 0.009), compare(sampler, baseline, 0.011),
                                        compare(negative, baseline), compare(scaled(sampler, -1), baseline)};
    decide(comparisons);
    CHECK(comparisons[0].verdict == Verdict::Better);
    CHECK_FALSE(comparisons[0].referenceTooPoor);
    for (std::size_t i : {1, 2, 3}) {
        CHECK(comparisons[i].referenceTooPoor);
        CHECK(comparisons[i].verdict == Verdict::Undecided);
    }
    CHECK(comparisons[2].ratio);
    CHECK_FALSE(comparisons[2].ci95);
    CHECK_FALSE(comparisons[3].ratio);
}

TEST_CASE("heavy tails are flagged") {
    PhiloxStream random(47);
    const std::vector<double> calm = lognormalErrors(16, 0.2, random);
    CHECK_FALSE(compare(calm, calm).heavyTailed);
    CHECK(compare(lognormalErrors(16, 1.5, random), calm).heavyTailed);
    CHECK(compare(calm, lognormalErrors(16, 1.5, random)).heavyTailed);
}

TEST_CASE("the smallest attainable adjusted p of a plan") {
    using Replicates = std::pair<std::size_t, std::size_t>;
    const std::vector<double> eight = smallestAdjustedP(std::vector<Replicates>(4, {8, 8}));
    CHECK(eight.front() == Approx(8.0 / 12870));
    const std::vector<double> mixed = smallestAdjustedP(std::vector<Replicates>{{3, 3}, {8, 8}});
    CHECK(mixed[0] == Approx(0.1));
    CHECK(mixed[1] == Approx(4.0 / 12870));
}

TEST_CASE("looking several times names a sampler a winner over itself in at most 6.5 % of experiments") {
    // Replicates are added until a comparison is decided, or up to 9: the worst that stopping can do.
    const bool paired = GENERATE(false, true);
    CAPTURE(paired);
    const Design design{.paired = paired, .looks = 3};
    const double wrong = frequency(500, 48, [&](PhiloxStream& random) {
        std::vector<double> a, b;
        for (const std::size_t n : {7, 8, 9}) {
            for (const double x : lognormalErrors(n - a.size(), 0.4, random)) a.push_back(x);
            for (const double x : lognormalErrors(n - b.size(), 0.4, random)) b.push_back(x);
            std::vector<Comparison> one{compare(a, b, 0, design)};
            decide(one, design.looks);
            if (anyWinner(one)) return true;
        }
        return false;
    });
    CHECK(wrong <= 0.065);
    CHECK(wrong >= 0.005);
}

TEST_CASE("each look has its share of the level") {
    PhiloxStream random(49);
    const std::vector<double> a = scaled(lognormalErrors(5, 0.1, random), 0.1), b = lognormalErrors(5, 0.1, random);
    std::vector<Comparison> once{compare(a, b)}, often{compare(a, b, 0, {.looks = 8})};
    decide(once);
    decide(often, 8);
    CHECK(often[0].pAdjusted == Approx(8 * once[0].pAdjusted));
    CHECK(once[0].verdict == Verdict::Better);
    CHECK(often[0].verdict == Verdict::Undecided);
    CHECK(often[0].ci95->low < once[0].ci95->low);
    CHECK(once[0].detectableRatio);
    CHECK_FALSE(often[0].detectableRatio);  // 2 of 252 splits are more than 0.05 / 8
}

TEST_CASE("comparisons of pairs use the pairs") {
    PhiloxStream random(50);
    const std::vector<double> baseline = lognormalErrors(8, 0.5, random);
    std::vector<double> sampler;
    for (const double x : baseline) sampler.push_back(0.9 * x * lognormalErrors(1, 0.01, random)[0]);
    std::vector<Comparison> paired{compare(sampler, baseline, 0, {.paired = true})}, free{compare(sampler, baseline)};
    decide(paired);
    decide(free);
    CHECK(paired[0].verdict == Verdict::Better);
    CHECK(paired[0].p == Approx(2.0 / 256));
    CHECK(*paired[0].detectableRatio > 0.95);
    CHECK(free[0].verdict == Verdict::Undecided);
    CHECK(*free[0].detectableRatio < 0.7);
    const std::vector<std::pair<std::size_t, std::size_t>> eight{{8, 8}};
    CHECK(smallestAdjustedP(eight, {.paired = true, .looks = 3})[0] == Approx(3 * 2.0 / 256));
}
