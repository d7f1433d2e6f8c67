#include "experiments/statistics/permutation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "experiments/statistics/welch.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

TEST_CASE("the permutation test matches enumeration by hand") {
    // Of the six splits of {1, 2, 3, 10} in pairs, {1,2 | 3,10} and its mirror image have the largest statistic.
    CHECK(permutationP(std::vector<double>{1, 2}, std::vector<double>{3, 10}) == Approx(2.0 / 6));
    // {1,3 | 2,10} is second.
    CHECK(permutationP(std::vector<double>{1, 3}, std::vector<double>{2, 10}) == Approx(4.0 / 6));
    CHECK(permutationP(std::vector<double>{1, 10}, std::vector<double>{2, 3}) == Approx(1));
    // A group of one: 9 is the farthest from the rest among five.
    CHECK(permutationP(std::vector<double>{9}, std::vector<double>{1, 2, 3, 4}) == Approx(1.0 / 5));
}

TEST_CASE("eight separated replicates against eight reach 1.6e-4 and no permutation less") {
    PhiloxStream random(1);
    const std::vector<double> a = lognormalErrors(8, 0.1, random);
    std::vector<double> b = lognormalErrors(8, 0.1, random);
    for (double& x : b) x *= 3;
    CHECK(permutationP(a, b) == Approx(2.0 / 12870).epsilon(1e-12));
    CHECK(permutationP(b, a) == Approx(2.0 / 12870).epsilon(1e-12));
    CHECK(smallestPermutationP(8, 8) == Approx(1.554e-4).epsilon(1e-3));
}

TEST_CASE("the smallest attainable p follows the number of splits") {
    CHECK(smallestPermutationP(1, 1) == 1);
    CHECK(smallestPermutationP(2, 2) == Approx(1.0 / 3));
    CHECK(smallestPermutationP(4, 4) == Approx(2.0 / 70));
    CHECK(smallestPermutationP(4, 6) == Approx(1.0 / 210));
    CHECK(smallestPermutationP(10, 10) == Approx(2.0 / 184756));
    CHECK(smallestPermutationP(16, 16) == Approx(1e-5));
    CHECK(smallestPermutationP(500, 500) == Approx(1e-5));
}

TEST_CASE("replicates without any difference have p = 1, without any spread the smallest p") {
    const std::vector<double> ones(5, 1.0);
    const std::vector<double> twos(5, 2.0);
    CHECK(permutationP(ones, ones) == 1);
    CHECK(permutationP(ones, twos) == Approx(smallestPermutationP(5, 5)));
    CHECK(permutationP(std::vector<double>(20, 1.0), std::vector<double>(20, 2.0)) == Approx(1e-5));
}

TEST_CASE("p does not depend on scale, order of groups or order of replicates") {
    PhiloxStream random(2);
    std::vector<double> a = lognormalErrors(6, 0.5, random);
    std::vector<double> b = lognormalErrors(7, 0.5, random);
    const double p = permutationP(a, b);
    CHECK(permutationP(b, a) == p);
    std::swap(a[0], a[5]);
    CHECK(permutationP(a, b) == p);
    for (double& x : a) x *= 1e-12;
    for (double& x : b) x *= 1e-12;
    CHECK(permutationP(a, b) == p);
}

TEST_CASE("p agrees with Welch's t over all splits, enumerated or drawn") {
    PhiloxStream random(3);
    for (std::size_t n : {4, 11}) {  // 4 v 7 has 330 splits, 11 v 10 has 352 716 and is drawn
        const std::size_t m = n == 4 ? 7 : 10;
        const std::vector<double> a = lognormalErrors(n, 0.6, random);
        std::vector<double> b = lognormalErrors(m, 0.3, random);
        for (double& x : b) x *= 1.3;
        b.back() = 4;  // one value that decides much, in the last place
        std::vector<double> all = a;
        all.insert(all.end(), b.begin(), b.end());
        std::vector<bool> inA(n + m);
        std::fill(inA.begin(), inA.begin() + static_cast<std::ptrdiff_t>(n), true);
        const double observed = std::abs(welchTest(a, b).t);
        int extreme = 0;
        int splits = 0;
        do {
            std::vector<double> groupA;
            std::vector<double> groupB;
            for (std::size_t i = 0; i < all.size(); ++i) (inA[i] ? groupA : groupB).push_back(all[i]);
            extreme += std::abs(welchTest(groupA, groupB).t) >= observed * (1 - 1e-9);
            ++splits;
        } while (std::prev_permutation(inA.begin(), inA.end()));
        const double exact = static_cast<double>(extreme) / splits;
        CAPTURE(n, exact);
        CHECK(permutationP(a, b) == Approx(exact).margin(n == 4 ? 1e-12 : 0.005));
        CHECK((permutationP(a, b, 1) == permutationP(a, b, 2)) == (n == 4));
    }
}

TEST_CASE("p-values of equal groups keep their level") {
    struct Case {
        std::size_t n, m;
        int trials;
    };
    const Case c = GENERATE(Case{8, 8, 4000}, Case{5, 8, 4000}, Case{16, 16, 400});
    CAPTURE(c.n, c.m);
    PhiloxStream random(21);
    std::vector<double> p;
    for (int i = 0; i < c.trials; ++i) {
        const std::vector<double> a = lognormalErrors(c.n, 0.5, random);
        p.push_back(permutationP(a, lognormalErrors(c.m, 0.5, random)));
    }
    for (double level : {0.01, 0.05, 0.2}) {
        const auto below = std::ranges::count_if(p, [level](double x) { return x <= level; });
        const double rejected = static_cast<double>(below) / c.trials;
        const double threeStandardErrors = 3 * std::sqrt(level * (1 - level) / c.trials);
        CAPTURE(level);
        CHECK(rejected <= level + threeStandardErrors);
        CHECK(rejected >= level - 0.002 - threeStandardErrors);
    }
}

TEST_CASE("eight against eight replicates see a factor of 1.6 at spread 0.2") {
    const double power = frequency(500, 22, [](PhiloxStream& random) {
        const std::vector<double> a = lognormalErrors(8, 0.2, random);
        std::vector<double> b = lognormalErrors(8, 0.2, random);
        for (double& x : b) x *= 1.6;
        return permutationP(a, b) <= 0.05;
    });
    CHECK(power >= 0.95);
}

TEST_CASE("a permutation test needs both groups") {
    CHECK_THROWS_AS(permutationP(std::vector<double>{}, std::vector<double>{1}), ulam::Error);
}
