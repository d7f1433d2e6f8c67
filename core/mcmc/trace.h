#pragma once
// Where a chain has been: a few scalars of its state at even intervals, for convergence diagnostics.

#include "core/mcmc/sample.h"

#include <algorithm>
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
    uint64_t stride() const { return stride_; }      ///< turns between two draws
    const std::vector<Draw>& draws() const { return draws_; }
    /// Those at a multiple of the stride, by a power of two.
    std::vector<Draw> drawsEvery(uint64_t stride) const {
        std::vector<Draw> some;
        for (size_t i = 0; i < draws_.size(); i += stride / stride_) some.push_back(draws_[i]);
        return some;
    }

private:
    Vec2f origin_{0, 0};
    std::vector<Draw> draws_;
    uint64_t turn_ = 0, stride_ = 1;
};

/// Draws of all traces at the same turns, as many of each: one chain may have had a turn more than another.
inline std::vector<std::vector<ChainTrace::Draw>> drawsAtSameTurns(const std::vector<const ChainTrace*>& traces) {
    uint64_t stride = 1;
    for (const ChainTrace* trace : traces) stride = std::max(stride, trace->stride());
    std::vector<std::vector<ChainTrace::Draw>> draws;
    size_t length = traces.empty() ? 0 : ChainTrace::kMost;
    for (const ChainTrace* trace : traces) {
        draws.push_back(trace->drawsEvery(stride));
        length = std::min(length, draws.back().size());
    }
    for (auto& own : draws) own.resize(length);
    return draws;
}

}  // namespace ulam
