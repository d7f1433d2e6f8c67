#pragma once
// Counter-based random numbers: Philox4x32-10. A number is a function of (key, chain, step, block), so that it does not
// matter which thread asks for it, or when.

#include "core/base/philox.h"

#include <span>

namespace ulam {

/// Four uniform numbers in (0, 1): one Philox block, and what one vertex of a walk consumes.
using Block = std::array<double, 4>;

/// Who draws: a run. Two keys made from different arguments share no numbers.
struct RandomKey {
    uint32_t low = 0, high = 0;
};

/// splitmix64's finaliser, applied between the three arguments.
inline RandomKey makeKey(uint64_t seed, uint64_t cell = 0, uint64_t replicate = 0) {
    auto mix = [](uint64_t z) {
        z += 0x9e3779b97f4a7c15ull;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    };
    const uint64_t k = mix(mix(mix(seed) ^ cell) ^ replicate);
    return {uint32_t(k), uint32_t(k >> 32)};
}

/// The sequential stream of one step of one chain (or of one sample of an ordinary sampler).
class Random {
public:
    Random() = default;
    Random(RandomKey key, uint32_t chain, uint64_t step)
        : key_{key.low, key.high}, counter_{0, chain, uint32_t(step), uint32_t(step >> 32)} {}
    /// The same stream with other numbers in the place of its first blocks: how audits force and displace single numbers.
    /// The script must outlive it.
    Random(RandomKey key, uint32_t chain, uint64_t step, std::span<const Block> script) : Random(key, chain, step) { script_ = script; }

    /// Blocks drawn so far.
    uint32_t blocks() const { return counter_[0]; }

    /// The next four numbers; leftovers of earlier single draws are kept.
    Block nextBlock() {
        const uint32_t block = counter_[0]++;
        if (block < script_.size()) [[unlikely]] return script_[block];
        if (block - first_ >= batch_.size()) drawBatch(block);
        return batch_[block - first_];
    }

    double operator()() {
        if (used_ == 4) {
            buffer_ = nextBlock();
            used_ = 0;
        }
        return buffer_[used_++];
    }

    /// Uniform in {0, …, n−1}.
    int index(int n) { return int((*this)() * n); }

private:
    void drawBatch(uint32_t first) {
        first_ = first;
        const auto bits = philox::fourBlocks({first, counter_[1], counter_[2], counter_[3]}, key_);
        const auto a = philox::uniform(bits[0]), b = philox::uniform(bits[1]), c = philox::uniform(bits[2]), d = philox::uniform(bits[3]);
        for (int i = 0; i < 4; ++i) batch_[size_t(i)] = {a[i], b[i], c[i], d[i]};
    }

    philox::Key key_{};
    philox::Counter counter_{};
    std::span<const Block> script_;
    std::array<Block, 4> batch_;
    uint32_t first_ = ~0u - 8;  ///< number of the batch's first block; at first one that is never drawn
    Block buffer_;
    int used_ = 4;
};

}  // namespace ulam
