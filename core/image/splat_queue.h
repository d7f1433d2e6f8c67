#pragma once
// Splats on their way to a film.

#include "core/image/film.h"

namespace ulam {

/// Each splat waits for a few others while the memory of its pixel is fetched, so that nobody waits for that memory. Flush
/// before the film is read.
class SplatQueue {
public:
    explicit SplatQueue(Film& film) : film_(film) {}

    void add(const Vec2f& raster, const Spectrum& value) {
        film_.fetchSplats(raster);
        Splat& slot = ring_[count_ % kSize];
        if (count_++ >= kSize) film_.splat(slot.raster, slot.value);
        slot = {raster, value};
    }
    void flush() {
        for (size_t i = count_ < kSize ? 0 : count_ - kSize; i < count_; ++i) film_.splat(ring_[i % kSize].raster, ring_[i % kSize].value);
        count_ = 0;
    }

private:
    struct Splat {
        Vec2f raster;
        Spectrum value;
    };
    static constexpr size_t kSize = 8;

    Film& film_;
    size_t count_ = 0;
    std::array<Splat, kSize> ring_;
};

}  // namespace ulam
