#pragma once
// A point of the primary sample space (Kelemen et al. 2002): the uniform numbers a path is made from.
//
// Numbers come in blocks of four, addressed by stream and block, so that a number's meaning does not depend on how long
// the rest of the path is:
//   Light   block 0: (emitter choice, position, position, –); block i+1: scattering at the walk's vertex i
//   Camera  block 0: (raster x, raster y, lens, lens);        block i: scattering at the walk's vertex i
//   Connect block i: next-event estimation from the camera walk's vertex i+1, as Light block 0
//   (scattering: direction, direction, lobe, Russian roulette)

#include "core/base/random.h"

#include <algorithm>
#include <cassert>

namespace ulam {

/// The longest path (in edges) that is held as a value.
inline constexpr int kMaxDepth = 31;
inline constexpr int kMaxVertices = kMaxDepth + 1;

enum class NumberStream : uint8_t { Light, Camera, Connect };
inline constexpr int kStreams = 3;

class PrimaryVector {
public:
    PrimaryVector() : size_{} {}
    PrimaryVector(const PrimaryVector& other) { *this = other; }
    PrimaryVector& operator=(const PrimaryVector& other) {
        size_ = other.size_;
        for (int s = 0; s < kStreams; ++s) std::copy_n(other.blocks_[s].begin(), size_[s], blocks_[s].begin());
        return *this;
    }

    int size(NumberStream s) const { return size_[int(s)]; }
    void clear() { size_ = {}; }
    void truncate(NumberStream s, int blocks) { size_[int(s)] = std::min(size_[int(s)], blocks); }
    Block& operator()(NumberStream s, int block) { return blocks_[int(s)][block]; }
    const Block& operator()(NumberStream s, int block) const { return blocks_[int(s)][block]; }
    void append(NumberStream s, const Block& block) {
        assert(size_[int(s)] <= kMaxVertices);
        blocks_[int(s)][size_[int(s)]++] = block;
    }

    template <class Archive>
    void archive(Archive& a) {
        a(size_);
        for (int s = 0; s < kStreams; ++s)
            for (int i = 0; i < size_[size_t(s)]; ++i) a(blocks_[size_t(s)][size_t(i)]);
    }

private:
    std::array<int, kStreams> size_;
    std::array<std::array<Block, kMaxVertices + 1>, kStreams> blocks_;
};

/// The one source of randomness of all sampling code: replays what the vector holds, extends it lazily, and can forget
/// what was not used.
class Numbers {
public:
    Numbers(PrimaryVector& vector, Random& random) : vector_(vector), random_(random) {}

    const Block& operator()(NumberStream s, int block) {
        while (vector_.size(s) <= block) vector_.append(s, random_.nextBlock());
        used_[size_t(s)] = std::max(used_[size_t(s)], block + 1);
        return vector_(s, block);
    }

    /// Leaves the vector with the blocks up to the last one used, which alone decide what was sampled.
    void forgetUnused() {
        for (int s = 0; s < kStreams; ++s) vector_.truncate(NumberStream(s), used_[size_t(s)]);
    }

private:
    PrimaryVector& vector_;
    Random& random_;
    std::array<int, kStreams> used_{};
};

}  // namespace ulam
