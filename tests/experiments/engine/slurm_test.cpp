#include "experiments/engine/slurm.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "tests/support/catch.h"

using namespace ulam;

namespace {

constexpr double kMinute = 60, kUsual = 15 * kMinute;

using Shares = std::vector<std::vector<std::size_t>>;

Shares sharesOf(std::vector<double> minutes) {
    for (double& m : minutes) m *= kMinute;
    return shareOut(minutes, kUsual);
}

double minutesOf(const std::vector<std::size_t>& share, const std::vector<double>& minutes) {
    double sum = 0;
    for (const std::size_t i : share) sum += minutes[i];
    return sum;
}

/// Every piece once, and tasks of 5 to 30 minutes but for the two exceptions.
void checkShares(const std::vector<double>& minutes) {
    CAPTURE(minutes);
    const Shares shares = sharesOf(minutes);
    std::vector<std::size_t> pieces;
    double shortest = INFINITY;
    for (const auto& share : shares) {
        REQUIRE(!share.empty());
        pieces.insert(pieces.end(), share.begin(), share.end());
        const double own = minutesOf(share, minutes);
        if (own > 30 + 1e-9) CHECK(share.size() == 1);
        for (const auto& other : shares)
            if (own < 5 && &other != &share) shortest = std::min(shortest, own + minutesOf(other, minutes));
    }
    CHECK(shortest > 30 - 1e-9);
    std::ranges::sort(pieces);
    std::vector<std::size_t> all(minutes.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    CHECK(pieces == all);
}

}  // namespace

TEST_CASE("tasks of jobs take 5 to 30 minutes", "[slurm]") {
    std::mt19937_64 random(7);
    const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
    for (int trial = 0; trial < 3000; ++trial) {
        // Of one length, of all lengths, and a few long ones among short ones.
        std::vector<double> minutes(std::size_t(uniform(1, 60)));
        const double most = std::exp(uniform(std::log(0.01), std::log(60.0)));
        for (double& m : minutes)
            m = trial % 3 == 0 ? most : trial % 3 == 1 ? uniform(0, most) : std::exp(uniform(-5, 4));
        checkShares(minutes);
        // Where no replicate is long there is no exception but that there is no more work.
        if (std::ranges::max(minutes) > 25 || std::reduce(minutes.begin(), minutes.end()) < 5) continue;
        for (const auto& share : sharesOf(minutes)) CHECK(minutesOf(share, minutes) >= 5 - 1e-9);
    }
}

TEST_CASE("where tasks of jobs end", "[slurm]") {
    CHECK(shareOut({}, kUsual).empty());
    CHECK(sharesOf({0}) == Shares{{0}});
    CHECK(sharesOf({0, 0, 0}) == Shares{{0, 1, 2}});
    CHECK(sharesOf({2, 1}) == Shares{{0, 1}});                // no more work
    CHECK(sharesOf({90}) == Shares{{0}});                     // a long replicate
    CHECK(sharesOf({15, 15}) == Shares{{0}, {1}});            // as long as is usual
    CHECK(sharesOf({14.9, 0.1, 15}) == Shares{{0, 1}, {2}});  // together as long
    CHECK(sharesOf({5, 5, 5, 5, 5, 5}) == Shares{{0, 1, 2}, {3, 4, 5}});
    CHECK(sharesOf({10, 10, 10, 10}) == Shares{{0, 1}, {2, 3}});
    CHECK(sharesOf({10, 10, 5}) == Shares{{0, 1}, {2}});  // a rest that is long enough
    CHECK(sharesOf({10, 10, 4}) == Shares{{0, 1, 2}});    // and one that is not
    CHECK(sharesOf({1, 40, 14, 1}) == Shares{{0, 2, 3}, {1}});
    CHECK(sharesOf({4, 26}) == Shares{{1, 0}});
    CHECK(sharesOf({4, 27}) == Shares{{1}, {0}});  // it fits with nothing
    CHECK(sharesOf({4, 90, 27, 20}) == Shares{{1}, {2}, {3, 0}});
    // Of another usual length: 2 to 12 minutes of 6.
    CHECK(shareOut({3 * kMinute, 3 * kMinute, 1.9 * kMinute}, 6 * kMinute) == Shares{{0, 1, 2}});
    CHECK(shareOut({3 * kMinute, 3 * kMinute, 2 * kMinute}, 6 * kMinute) == Shares{{0, 1}, {2}});
}
