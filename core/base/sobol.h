#pragma once
// Four dimensions of the Sobol' sequence, scrambled: well distributed blocks of random numbers.

#include "core/base/random.h"

namespace ulam {

/// Sobol's sequence (1967) with the direction numbers of Joe & Kuo (2008), its order and its digits scrambled after Owen
/// (1995) by hashes (Burley 2020, "Practical hash-based Owen scrambling"; Laine & Karras 2011), then shifted digit by digit
/// by true random numbers: whatever the hashes do, every point alone is uniform, and sequences of different shifts are
/// independent. 2^k consecutive points are a net of which each pair of numbers covers the square evenly.
class ScrambledSobol {
public:
    using Bits = uint32_t __attribute__((vector_size(16)));

    ScrambledSobol(uint32_t seed, const Bits& shift) : seed_(seed), shift_(shift) {}

    Block operator()(uint32_t index) const {
        const uint32_t i = reverse(scramble(reverse(index), seed_));
        Bits digits = kTable[0][i & 255] ^ kTable[1][i >> 8 & 255] ^ kTable[2][i >> 16 & 255] ^ kTable[3][i >> 24];
        digits = scramble(digits, Bits{0x5a2c87d1u, 0x9b3f1e65u, 0xc64d7923u, 0x37e8a0bfu} ^ seed_);
        digits = reverse(digits) ^ shift_;
        Block u;
        for (int k = 0; k < 4; ++k) u[size_t(k)] = (double(digits[k]) + 0.5) * 0x1p-32;
        return u;
    }

private:
    /// A permutation of digits that flips each by those before it, the first being the lowest bit.
    template <class T>
    static T scramble(T x, const T& seed) {
        x += seed;
        x ^= x * 0x6c50b47cu;
        x ^= x * 0xb82f1e52u;
        x ^= x * 0xc7afe638u;
        x ^= x * 0x8d22f6e6u;
        return x;
    }

    template <class T>
    static constexpr T reverse(T x) {
        x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
        x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
        x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
        x = (x >> 8 & 0x00ff00ffu) | (x & 0x00ff00ffu) << 8;
        return x >> 16 | x << 16;
    }

    /// The point of an index is the sum (exclusive or) of those of its bytes; digits from the lowest bit on.
    using Table = std::array<std::array<Bits, 256>, 4>;
    static Table table();
    inline static const Table kTable = table();

    uint32_t seed_;
    Bits shift_;
};

}  // namespace ulam
