#pragma once
// Sums that do not depend on the order of their terms: 128-bit fixed point, 64 fractional bits. So an image is the same
// bytes whatever thread added which sample when.

#include <cmath>
#include <cstdint>

namespace ulam {

class FixedSum {
public:
    /// Largest magnitude of a term; larger and non-finite terms are the caller's to refuse.
    static constexpr double kLargestTerm = 0x1p48;

    void add(double x) {
        const double whole = std::floor(x);
        sum_ += (static_cast<__int128>(static_cast<int64_t>(whole)) << 64) + static_cast<uint64_t>((x - whole) * 0x1p64);
    }
    void add(const FixedSum& other) { sum_ += other.sum_; }
    template <class Archive>
    void archive(Archive& a) {
        a.bytes(&sum_, sizeof sum_);
    }
    double value() const { return static_cast<double>(sum_) * 0x1p-64; }

private:
    __int128 sum_ = 0;
};

}  // namespace ulam
