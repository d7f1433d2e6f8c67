#pragma once
// Kronecker sequences: a low-discrepancy point set of any length in one line a number.

#include <array>
#include <cstdint>

namespace ulam {

/// Point i is (shift_k + i α_k) mod 1 with α_k = φ^−k, where φ^(D+1) = φ + 1: the golden ratio's generalisation, whose
/// powers are badly approximable together (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences"). Every
/// dimension alone is even; of pairs the first are, a few later ones are less even than independent points.
/// With shifts that are uniform in (0, 1) every single point is so too (Cranley & Patterson 1976).
template <int D>
class KroneckerSequence {
public:
    KroneckerSequence() = default;
    explicit KroneckerSequence(const std::array<double, D>& shift) {
        for (int k = 0; k < D; ++k) shift_[k] = uint64_t(shift[k] * 0x1p32) << 32;
    }

    /// Number k of point i, in the middle of one of 2^32 cells as Random's numbers are.
    double operator()(uint64_t i, int k) const { return (double((shift_[k] + i * kStep[k]) >> 32) + 0.5) * 0x1p-32; }

private:
    /// α_k in units of 2^−64: arithmetic modulo 2^64 takes the fractional part.
    static constexpr std::array<uint64_t, D> steps() {
        auto power = [](double x, int n) {
            double p = 1;
            while (n-- > 0) p *= x;
            return p;
        };
        double low = 1, high = 2;
        for (int i = 0; i < 60; ++i) {
            const double middle = (low + high) / 2;
            (power(middle, D + 1) < middle + 1 ? low : high) = middle;
        }
        std::array<uint64_t, D> step{};
        for (int k = 0; k < D; ++k) step[k] = uint64_t(0x1p64 / power(low, k + 1));
        return step;
    }
    static constexpr std::array<uint64_t, D> kStep = steps();

    std::array<uint64_t, D> shift_{};
};

}  // namespace ulam
