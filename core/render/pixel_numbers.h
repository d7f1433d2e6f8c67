#pragma once
// Random numbers of independent samples, well distributed among the samples of a pixel.

#include "core/base/sobol.h"
#include "core/path/primary_vector.h"

namespace ulam {

/// The numbers that decide most come from scrambled Sobol' sequences, one for every block and pixel: a sample's place on
/// film and lens, its first scattering and next-event estimation, and the light's point and direction. Every sample alone
/// is uniform, and pixels know nothing of each other.
class PixelNumbers {
public:
    /// `stream`: the random stream that shifts the sequences; nobody else may draw from it.
    PixelNumbers(RandomKey key, uint32_t stream) : key_{key.low, key.high}, stream_(stream) {}

    /// The first numbers of a pixel's sample n (from 0); u must be empty. `lightWalk`: those of the light too.
    void begin(uint32_t pixel, uint32_t n, bool lightWalk, PrimaryVector& u) const {
        const auto a = philox::fourBlocks({0, stream_, pixel, 0}, key_);
        const uint32_t seed = uint32_t(a[3][0]);
        u.append(NumberStream::Camera, sequence(seed, a[0])(n));
        u.append(NumberStream::Camera, sequence(seed + 1, a[1])(n));
        u.append(NumberStream::Connect, sequence(seed + 2, a[2])(n));
        if (!lightWalk) return;
        const auto b = philox::fourBlocks({4, stream_, pixel, 0}, key_);
        u.append(NumberStream::Light, sequence(seed + 3, b[0])(n));
        u.append(NumberStream::Light, sequence(seed + 4, b[1])(n));
    }

private:
    static ScrambledSobol sequence(uint32_t seed, const philox::Lanes& shift) {
        constexpr uint32_t kSpread = 0x9E3779B9;  // neighbours' bits shall have nothing in common
        return {seed * kSpread, ScrambledSobol::Bits{uint32_t(shift[0]), uint32_t(shift[1]), uint32_t(shift[2]), uint32_t(shift[3])}};
    }

    philox::Key key_;
    uint32_t stream_;
};

}  // namespace ulam
