#include "core/image/film.h"

namespace ulam {

void FilmPlane::add(const FilmPlane& other) {
    if (other.empty()) return;
    if (empty()) sums_.resize(other.sums_.size());
    for (size_t i = 0; i < sums_.size(); ++i)
        for (int c = 0; c < 3; ++c) sums_[i][c].add(other.sums_[i][c]);
}

bool Film::accept(const Spectrum& v) {
    // Also false for NaN.
    const double limit = FixedSum::kLargestTerm;
    if (std::abs(v.x) < limit && std::abs(v.y) < limit && std::abs(v.z) < limit) return true;
    ++nonFinite_;
    return false;
}

void Film::countSample(int pixel) {
    if (counts_.empty()) counts_.resize(size_t(pixels()));
    ++counts_[size_t(pixel)];
}

void Film::addSample(int pixel, const Spectrum& value) {
    if (isBlack(value) || !accept(value)) return;
    if (samples_.empty()) samples_ = FilmPlane(size_t(pixels()));
    samples_.add(size_t(pixel), value.x, value.y, value.z);
}

void Film::splat(const Vec2f& raster, const Spectrum& value) {
    if (!accept(value)) return;
    if (splats_.empty()) splats_ = FilmPlane(size_t(pixels()));
    if (filter_.type() == ReconstructionFilter::Type::Box) {
        const int x = int(raster.x), y = int(raster.y);
        if (x >= 0 && x < width_ && y >= 0 && y < height_) splats_.add(size_t(y * width_ + x), value.x, value.y, value.z);
        return;
    }
    const float r = filter_.radius();
    const int x0 = std::max(0, int(std::ceil(raster.x - r - 0.5f))), x1 = std::min(width_ - 1, int(std::floor(raster.x + r - 0.5f)));
    const int y0 = std::max(0, int(std::ceil(raster.y - r - 0.5f))), y1 = std::min(height_ - 1, int(std::floor(raster.y + r - 0.5f)));
    for (int y = y0; y <= y1; ++y) {
        const double hy = filter_(y + 0.5 - raster.y);
        for (int x = x0; x <= x1; ++x) {
            const double h = hy * filter_(x + 0.5 - raster.x);
            splats_.add(size_t(y * width_ + x), h * value.x, h * value.y, h * value.z);
        }
    }
}

void Film::merge(const Film& other) {
    samples_.add(other.samples_);
    splats_.add(other.splats_);
    if (!other.counts_.empty()) {
        if (counts_.empty()) counts_.resize(size_t(pixels()));
        for (size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
    }
    nonFinite_ += other.nonFinite_;
}

Image Film::developCountedBy(const Film& counter, double splatScale) const {
    Image image(width_, height_);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        Spectrum v(0.0);
        if (!samples_.empty() && counter.counts_[i] > 0) v += samples_[i] / double(counter.counts_[i]);
        if (!splats_.empty()) v += splats_[i] * splatScale;
        image.pixels[i] = Rgb(float(v.x), float(v.y), float(v.z));
    }
    return image;
}

}  // namespace ulam
