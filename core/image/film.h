#pragma once
// The film: what the samples of one worker add up to. Sums are exact in fixed point, so films merge in any order.

#include "core/base/fixed_sum.h"
#include "core/base/large_pages.h"
#include "core/image/filter.h"
#include "core/image/image.h"

#include <array>
#include <cstdint>
#include <vector>

namespace ulam {

/// One colour per pixel.
class FilmPlane {
public:
    FilmPlane() = default;
    explicit FilmPlane(size_t pixels) : sums_(pixels) {}
    bool empty() const { return sums_.empty(); }
    void add(size_t pixel, double r, double g, double b) {
        sums_[pixel][0].add(r);
        sums_[pixel][1].add(g);
        sums_[pixel][2].add(b);
    }
    void add(const FilmPlane& other);
    template <class Archive>
    void archive(Archive& a) {
        constexpr size_t kPixel = sizeof sums_[0];
        sums_.resize(a.count(sums_.size(), kPixel));
        a.bytes(sums_.data(), sums_.size() * kPixel);
    }
    /// Both ends: a pixel may lie on two cache lines.
    [[gnu::always_inline]] void fetch(size_t pixel) const {
        __builtin_prefetch(&sums_[pixel], 1);
        __builtin_prefetch(&sums_[pixel].back(), 1);
    }
    Spectrum operator[](size_t pixel) const {
        return {sums_[pixel][0].value(), sums_[pixel][1].value(), sums_[pixel][2].value()};
    }

private:
    std::vector<std::array<FixedSum, 3>, LargePageAllocator<std::array<FixedSum, 3>>> sums_;
};

/// Two estimators side by side, whose expectations add up to the image:
/// the mean of the samples taken for a pixel, and a density of splats over the raster.
class Film {
public:
    Film(int width, int height, const ReconstructionFilter& filter) : width_(width), height_(height), filter_(filter) {}

    int width() const { return width_; }
    int height() const { return height_; }
    int pixels() const { return width_ * height_; }

    /// A camera sample of a pixel, its raster offset drawn from the filter: E = radiance convolved with the filter.
    void addSample(int pixel, const Spectrum& value);
    /// A sample of a pixel that found no light: it counts in the mean.
    void countSample(int pixel);
    /// Spreads a value over the pixels around a raster position (pixels from the upper left corner).
    void splat(const Vec2f& raster, const Spectrum& value);
    /// Has the memory around a raster position brought near. (Inlined, as GCC leaves out calls without effect.)
    [[gnu::always_inline]] void fetchSplats(const Vec2f& raster) const {
        const int x = int(raster.x), y = int(raster.y);
        if (x >= 0 && x < width_ && y >= 0 && y < height_ && !splats_.empty()) splats_.fetch(size_t(y * width_ + x));
    }

    void merge(const Film& other);
    /// Takes everything from another film and leaves that empty.
    void take(Film& other) {
        merge(other);
        other = Film(width_, height_, filter_);
    }
    template <class Archive>
    void archive(Archive& a) {
        a(samples_, splats_, counts_, nonFinite_);
    }
    uint64_t nonFinite() const { return nonFinite_; }
    /// That a film takes once it has been given samples, splats or both.
    static double bytes(double pixels, bool samples, bool splats) {
        constexpr double kPlane = sizeof(std::array<FixedSum, 3>);
        return pixels * ((samples ? kPlane : 0) + (splats ? kPlane : 0));
    }
    static double countBytes(double pixels) { return pixels * sizeof(uint32_t); }

    /// Means of the samples plus splatScale × splats.
    Image develop(double splatScale) const { return developCountedBy(*this, splatScale); }
    /// The same where another film counted the samples (films that share them out, by technique say).
    Image developCountedBy(const Film& counter, double splatScale) const;

private:
    bool accept(const Spectrum& value);

    int width_, height_;
    ReconstructionFilter filter_;
    FilmPlane samples_, splats_;
    std::vector<uint32_t> counts_;
    uint64_t nonFinite_ = 0;
};

}  // namespace ulam
