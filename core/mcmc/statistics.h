#pragma once
// What is counted about each mutation of a chain sampler.

#include <array>
#include <cstdint>

namespace ulam {

/// Why a proposal is none.
enum class Reject : uint8_t { None, OffScreen, Missed, Occluded, ZeroTarget, NotInvertible, SolverFailed, NotFinite };
inline constexpr int kRejectReasons = 8;

inline const char* name(Reject reason) {
    constexpr const char* names[kRejectReasons] = {"none",           "off_screen",     "missed",       "occluded",
                                                   "zero_target",    "not_invertible", "solver_failed", "not_finite"};
    return names[int(reason)];
}

struct MutationStatistics {
    uint64_t proposed = 0;
    uint64_t accepted = 0;
    uint64_t zero = 0;                               ///< proposals without a state: the sum of `rejected`
    std::array<uint64_t, kRejectReasons> rejected{}; ///< by reason
    double seconds = 0;                              ///< thread time, extrapolated from timed steps
    double squaredJump = 0;                          ///< Σ α · squared raster distance, pixels²

    template <class Archive>
    void archive(Archive& a) {
        a(proposed, accepted, zero, rejected, seconds, squaredJump);
    }
    void merge(const MutationStatistics& o) {
        proposed += o.proposed, accepted += o.accepted, zero += o.zero;
        for (int i = 0; i < kRejectReasons; ++i) rejected[i] += o.rejected[i];
        seconds += o.seconds, squaredJump += o.squaredJump;
    }
};

}  // namespace ulam
