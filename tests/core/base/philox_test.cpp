// The vectorised generator gives the bits of the reference implementation.

#include "core/base/philox.h"

#include <Random123/philox.h>

#include "core/base/random.h"
#include "tests/support/catch.h"

using namespace ulam;

TEST_CASE("four blocks at once are Random123's") {
    uint32_t state = 12345;
    const auto next = [&state] { return state = state * 1664525u + 1013904223u; };
    for (int trial = 0; trial < 1000; ++trial) {
        const philox::Key key{next(), next()};
        // The first counter may wrap around.
        const philox::Counter first{trial % 10 == 0 ? ~0u - uint32_t(trial) % 4 : next(), next(), next(), next()};
        const auto blocks = philox::fourBlocks(first, key);
        for (uint32_t j = 0; j < 4; ++j) {
            const auto expected = r123::Philox4x32{}({{first[0] + j, first[1], first[2], first[3]}}, {{key[0], key[1]}});
            for (size_t i = 0; i < 4; ++i) {
                REQUIRE(blocks[i][j] == expected[i]);
                REQUIRE(philox::uniform(blocks[i])[j] == (expected[i] + 0.5) * 0x1p-32);
            }
        }
    }
}

TEST_CASE("a stream is its blocks in order, whatever is drawn singly in between") {
    const RandomKey key = makeKey(7, 8, 9);
    Random blocks(key, 3, uint64_t(5) << 33), singles = blocks;
    std::vector<double> all;
    for (int b = 0; b < 9; ++b) {
        const Block block = blocks.nextBlock();
        const auto bits = r123::Philox4x32{}({{uint32_t(b), 3, 0, 10}}, {{key.low, key.high}});
        for (size_t i = 0; i < 4; ++i) {
            REQUIRE(block[i] == (bits[i] + 0.5) * 0x1p-32);
            all.push_back(block[i]);
        }
    }
    for (const double u : all) REQUIRE(singles() == u);
    CHECK(blocks.blocks() == 9);
}
