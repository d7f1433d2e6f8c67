#pragma once
// Where a chain has been: a few scalars of its state at even intervals, for convergence diagnostics.

#include "core/mcmc/sample.h"

#include <vector>

namespace ulam {

class ChainTrace {
public:
    static constexpr int kScalars = 5;
    static constexpr size_t kMost = 256;  ///< states that are kept
    static constexpr const char* kNames[kScalars] = {"raster_x", "raster_y", "log_target", "path_length", "feature"};
    using Draw = std::array<float, kScalars>;

    /// Called once a turn; keeps every stride-th state, at most kMost of them.
    void record(const Sample& x, uint32_t feature) {
        if (turn_++ % stride_ != 0) return;
        const Vec2f r = x.splats[0].raster;
        draws_.push_back({r.x, r.y, float(x.logTarget), float(x.path.length()), feature == kNone ? -1.0f : float(feature)});
        if (draws_.size() < kMost) return;
        for (size_t i = 0; 2 * i < draws_.size(); ++i) draws_[i] = draws_[2 * i];
        draws_.resize(draws_.size() / 2);
        stride_ *= 2;
    }
    /// The state before the first step; makes room, so that recording allocates nothing.
    void start(const Sample& x) {
        origin_ = x.splats[0].raster;
        draws_.reserve(kMost);
    }

    template <class Archive>
    void archive(Archive& a) {
        a(origin_, draws_, turn_, stride_);
    }

    const Vec2f& origin() const { return origin_; }  ///< raster position of the first state
    const std::vector<Draw>& draws() const { return draws_; }

private:
    Vec2f origin_{0, 0};
    std::vector<Draw> draws_;
    uint64_t turn_ = 0, stride_ = 1;
};

}  // namespace ulam
