#pragma once
// Where on the image chains are, and how often they leave from there.

#include "core/base/vector.h"
#include "core/image/image.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace ulam {

/// For each pixel, the proposals made from states that lie in it, and how many of them were accepted.
class StateCounts {
public:
    StateCounts(int width, int height) : width_(width), height_(height), counts_(size_t(width) * size_t(height)) {}

    /// `raster`: of the state before the step, in pixels from the upper left corner.
    void add(const Vec2f& raster, bool accepted) {
        const int x = std::clamp(int(raster.x), 0, width_ - 1), y = std::clamp(int(raster.y), 0, height_ - 1);
        Counts& counts = counts_[size_t(y) * size_t(width_) + size_t(x)];
        ++counts.proposed;
        counts.accepted += accepted;
    }

    /// Takes everything from another and leaves that empty.
    void take(StateCounts& other) {
        for (size_t i = 0; i < counts_.size(); ++i) {
            const Counts more = std::exchange(other.counts_[i], {});
            counts_[i].proposed += more.proposed;
            counts_[i].accepted += more.accepted;
        }
    }

    template <class Archive>
    void archive(Archive& a) {
        counts_.resize(a.count(counts_.size(), sizeof(Counts)));
        a.bytes(counts_.data(), counts_.size() * sizeof(Counts));
    }

    static double bytes(double pixels) { return pixels * sizeof(Counts); }

    /// Adds "proposed" and "accepted", grey, in steps.
    void develop(std::map<std::string, Image>& images) const {
        Image proposed(width_, height_), accepted(width_, height_);
        for (size_t i = 0; i < counts_.size(); ++i) {
            proposed.pixels[i] = Rgb(float(counts_[i].proposed));
            accepted.pixels[i] = Rgb(float(counts_[i].accepted));
        }
        images["proposed"] = std::move(proposed);
        images["accepted"] = std::move(accepted);
    }

private:
    struct Counts {
        uint64_t proposed = 0, accepted = 0;
    };

    int width_, height_;
    std::vector<Counts> counts_;
};

}  // namespace ulam
