#pragma once
// The random numbers of resampling: Philox4x32-10 (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3"),
// so that an interval or a p-value is the same on every machine and in every run of the analysis.

#include <Random123/philox.h>

#include <cstddef>
#include <cstdint>
#include <limits>

namespace ulam::statistics {

/// Seed of every bootstrap and Monte Carlo permutation unless a caller gives its own.
inline constexpr std::uint64_t kResamplingSeed = 1;

/// Also a standard UniformRandomBitGenerator.
class PhiloxStream {
public:
    using result_type = std::uint32_t;

    explicit PhiloxStream(std::uint64_t seed)
        : key_{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}} {}

    static constexpr result_type min() { return 0; }
    static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }

    result_type operator()() {
        if (used_ == 4) {
            block_ = r123::Philox4x32()(counter_, key_);
            counter_.incr();
            used_ = 0;
        }
        return block_[used_++];
    }

    /// Uniform on 0 … count - 1; the error of each probability is below 2^-32.
    std::size_t index(std::size_t count) { return (static_cast<std::uint64_t>((*this)()) * count) >> 32; }

private:
    r123::Philox4x32::key_type key_;
    r123::Philox4x32::ctr_type counter_{};
    r123::Philox4x32::ctr_type block_{};
    unsigned used_ = 4;
};

}  // namespace ulam::statistics
