#include "core/render/pixel_numbers.h"

#include "tests/support/chi_square.h"

#include <algorithm>

using namespace ulam;

namespace {

constexpr std::pair<NumberStream, int> kBlocks[] = {
    {NumberStream::Camera, 0}, {NumberStream::Camera, 1}, {NumberStream::Connect, 0}, {NumberStream::Light, 0}, {NumberStream::Light, 1}};

/// All numbers of a sample in a row.
std::vector<double> numbers(const PixelNumbers& source, uint32_t pixel, uint32_t n) {
    PrimaryVector u;
    source.begin(pixel, n, true, u);
    std::vector<double> all;
    for (const auto& [stream, block] : kBlocks) all.insert(all.end(), u(stream, block).begin(), u(stream, block).end());
    return all;
}

}  // namespace

TEST_CASE("a pixel's samples take each of equal parts of every number once") {
    const PixelNumbers source(makeKey(1), 1);
    for (const uint32_t pixel : {0u, 1u, 262'143u}) {
        std::vector<std::vector<int>> counts(20, std::vector<int>(64));
        for (uint32_t n = 0; n < 64; ++n) {
            const std::vector<double> u = numbers(source, pixel, n);
            for (size_t k = 0; k < u.size(); ++k) ++counts[k][size_t(u[k] * 64)];
        }
        for (const auto& of : counts) REQUIRE(std::all_of(of.begin(), of.end(), [](int c) { return c == 1; }));
    }
}

TEST_CASE("over pixels, numbers of one sample are uniform and independent, and so are neighbours") {
    const PixelNumbers source(makeKey(2), 1);
    constexpr int kSide = 8;
    std::vector<double> flat(kSide * kSide, 1.0 / (kSide * kSide));
    const auto check = [&](auto&& first, auto&& second) {
        std::vector<double> counts(flat.size());
        for (uint32_t pixel = 0; pixel < 20'000; ++pixel) ++counts[size_t(int(first(pixel) * kSide) * kSide + int(second(pixel) * kSide))];
        CHECK_FIT(misfit(counts, flat));
    };
    const auto number = [&](uint32_t n, size_t k) { return [&source, n, k](uint32_t pixel) { return numbers(source, pixel, n)[k]; }; };
    for (const auto& [a, b] : {std::pair<size_t, size_t>{0, 1}, {0, 4}, {4, 8}, {5, 9}, {1, 12}, {12, 16}, {17, 19}}) {
        INFO(a << ' ' << b);
        check(number(5, a), number(5, b));
    }
    // Neighbouring pixels.
    check(number(3, 2), [&](uint32_t pixel) { return numbers(source, pixel + 1, 3)[2]; });
}

TEST_CASE("without a light walk its numbers are left to whoever asks") {
    PrimaryVector u;
    PixelNumbers(makeKey(1), 1).begin(7, 0, false, u);
    CHECK(u.size(NumberStream::Light) == 0);
    CHECK(u.size(NumberStream::Camera) == 2);
    CHECK(u.size(NumberStream::Connect) == 1);
}
