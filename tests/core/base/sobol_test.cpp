#include "core/base/sobol.h"

#include "tests/support/chi_square.h"

#include <cmath>

using namespace ulam;

namespace {

constexpr int kDigits = 10;
constexpr uint32_t kPoints = 1u << kDigits;

/// Digits of a number by which elementary intervals ask for each dimension.
using Split = std::array<int, 4>;

/// Numbers of points in the elementary intervals: boxes with 2^split[k] parts along dimension k.
std::vector<int> countByBox(const std::vector<Block>& points, const Split& split) {
    int boxes = 1;
    for (const int digits : split) boxes <<= digits;
    std::vector<int> counts(size_t(boxes), 0);
    for (const Block& u : points) {
        int box = 0;
        for (size_t k = 0; k < 4; ++k) box = (box << split[k]) + int(std::ldexp(u[k], split[k]));
        ++counts[size_t(box)];
    }
    return counts;
}

std::vector<Block> net(uint32_t seed, uint32_t first) {
    const ScrambledSobol sequence(seed, ScrambledSobol::Bits{seed * 3, seed * 5, seed * 7, seed * 11});
    std::vector<Block> points;
    for (uint32_t i = 0; i < kPoints; ++i) points.push_back(sequence(first + i));
    return points;
}

}  // namespace

TEST_CASE("2^m consecutive points of Sobol's sequence are a (t, m, s)-net, however they are scrambled") {
    // t is the sum of the polynomials' degrees less one: 0 for the first two dimensions, 1 with the third, 3 with all.
    for (const auto& [seed, first] : {std::pair{0u, 0u}, {17u, 0u}, {12345u, 5 * kPoints}, {0xdeadbeefu, 4096 * kPoints}}) {
        const std::vector<Block> points = net(seed, first);
        for (int a = 0; a <= kDigits; ++a)
            for (int b = 0; a + b <= kDigits; ++b)
                for (int c = 0; a + b + c <= kDigits; ++c)
                    for (int d = 0; a + b + c + d <= kDigits; ++d) {
                        const int t = d > 0 ? 3 : c > 0 && (a > 0 || b > 0) ? 1 : 0;
                        if (a + b + c + d != kDigits - t) continue;
                        INFO(seed << ": " << a << ' ' << b << ' ' << c << ' ' << d);
                        for (const int count : countByBox(points, {a, b, c, d})) REQUIRE(count == 1 << t);
                    }
    }
}

TEST_CASE("sequences of different seeds have nothing to do with each other") {
    // Numbers of one and of the other in 16 × 16 boxes: as independent ones, since both are permuted.
    std::vector<double> counts(256), flat(256, 1.0 / 256);
    for (uint32_t seed = 1; seed <= 200; ++seed) {
        const std::vector<Block> one = net(seed * 0x9E3779B9u, 0), other = net((seed + 1) * 0x9E3779B9u, 0);
        for (size_t i = 0; i < 64; ++i)
            for (size_t k = 0; k < 4; ++k) ++counts[size_t(int(one[i][k] * 16) * 16 + int(other[i][(k + seed) % 4] * 16))];
    }
    CHECK_FIT(misfit(counts, flat));
}

TEST_CASE("a point that is shifted by random digits is uniform") {
    std::vector<double> counts(100), flat(100, 0.01);
    for (uint64_t i = 0; i < 100'000; ++i) {
        Random random(makeKey(3), 0, i);
        const auto digits = [&] { return uint32_t(random() * 0x1p32); };
        ++counts[size_t(ScrambledSobol(8, ScrambledSobol::Bits{digits(), digits(), digits(), digits()})(17)[i % 4] * 100)];
    }
    CHECK_FIT(misfit(counts, flat));
}
