#include "core/scene/environment_map.h"

namespace ulam {
namespace {

/// How far rounding of directions moves them over the horizon: what is that far below it is on it.
constexpr double kHorizonRounding = 5e-7;

/// The part of a small disc that is above a straight horizon; `height`: of its centre, in radii.
double shareAbove(double height) {
    const double x = std::clamp(height, -1.0, 1.0);
    return (std::acos(-x) + x * std::sqrt(1 - x * x)) / kPi;
}

}  // namespace

EnvironmentMap::EnvironmentMap(Image image, double scale, const std::array<Vec3f, 3>& axes, Extent extent,
                               const std::optional<SunDisc>& sun)
    : image_(std::move(image)), axes_(axes), extent_(extent), sun_(sun) {
    for (Rgb& p : image_.pixels) p *= float(scale);
    std::vector<double> rows, cells(size_t(image_.width));
    for (int j = 0; j + 1 < image_.height; ++j) {
        // ∫ over the cell of what grows linearly with θ from the upper row to the lower one, and of the rest.
        const double step = kPi / (image_.height - 1), all = cellSolidAngle(j);
        const double from = extent == Extent::Sphere ? j * step : hemisphereAngle(j, image_.height);
        const double to = extent == Extent::Sphere ? (j + 1) * step : hemisphereAngle(j + 1, image_.height);
        const double angle = extent == Extent::Sphere ? step : to - from;
        const double lower = 2 * kPi / image_.width * ((std::sin(to) - std::sin(from)) / angle - cosineOfRow(j + 1));
        const auto mean = [&](int row, int i) { return luminance(Spectrum(texel(row, i)) + Spectrum(texel(row, i + 1))) / 2; };
        double sum = 0;
        for (int i = 0; i < image_.width; ++i) sum += cells[size_t(i)] = mean(j, i) * (all - lower) + mean(j + 1, i) * lower;
        rows.push_back(sum);
        if (!(sum > 0)) std::fill(cells.begin(), cells.end(), 1.0);  // a dark row is never chosen
        columns_.emplace_back(cells);
    }
    double total = 0;
    for (const double r : rows) total += r;
    if (total > 0) rows_ = DiscreteDistribution(rows);
    if (sun_) {
        const double sine = double(dot(sun_->direction(), axes_[1]));
        const double seen = extent == Extent::Sphere ? 1 : shareAbove(std::asin(std::clamp(sine, -1.0, 1.0)) / sun_->radius());
        sunLuminance_ = luminance(sun_->radiance()) * sun_->solidAngle() * seen;
        if (sunLuminance_ > 0) sunShare_ = sunLuminance_ / totalLuminance();
    }
}

double EnvironmentMap::cellSolidAngle(int row) const {
    return 2 * kPi / image_.width * (cosineOfRow(row) - cosineOfRow(row + 1));
}

EnvironmentMap::Place EnvironmentMap::place(const Vec3f& w) const {
    const double x = dot(w, axes_[0]), y = dot(w, axes_[1]), z = dot(w, axes_[2]);
    double column = inverseAzimuth(-z, x) * image_.width - 0.5;
    if (column < 0) column += image_.width;
    // Near the poles only x and z know how near.
    const double theta = std::atan2(std::hypot(x, z), y);
    const int i = std::min(int(column), image_.width - 1);
    if (extent_ == Extent::UpperHemisphere) {
        const double elevation = kPi / 2 - theta, t = 1 - std::sqrt(std::max(0.0, elevation) / (kPi / 2));
        const double row = t * (image_.height - 1);
        const int j = std::min(int(row), image_.height - 2);
        return {j, i, row - j, column - i, std::max(0.0, std::cos(theta)), elevation < -kHorizonRounding};
    }
    const double row = theta / kPi * (image_.height - 1);
    const int j = std::min(int(row), image_.height - 2);
    return {j, i, row - j, column - i, std::cos(kPi * row / (image_.height - 1)), false};
}

Spectrum EnvironmentMap::pictureRadiance(const Place& p) const {
    if (p.outside) return Spectrum(0.0);
    const Spectrum above = Spectrum(texel(p.row, p.column)) * (1 - p.along) + Spectrum(texel(p.row, p.column + 1)) * p.along;
    const Spectrum below = Spectrum(texel(p.row + 1, p.column)) * (1 - p.along) + Spectrum(texel(p.row + 1, p.column + 1)) * p.along;
    return above * (1 - p.down) + below * p.down;
}

Spectrum EnvironmentMap::radiance(const Vec3f& w) const {
    const Place p = place(w);
    const Spectrum picture = pictureRadiance(p);
    return sun_ && !p.outside && sun_->holds(w) ? picture + sun_->radiance() : picture;
}

Vec3f EnvironmentMap::sample(double u, double v) const {
    if (sun_) {
        if (u < sunShare_) return sun_->sample(u / sunShare_, v);
        u = (u - sunShare_) / (1 - sunShare_);
    }
    const int row = int(rows_.sample(u)), column = int(columns_[size_t(row)].sample(v));
    const double high = cosineOfRow(row), low = cosineOfRow(row + 1), y = high + u * (low - high);
    const double phi = 2 * kPi * (column + 0.5 + v) / image_.width;
    const double r = std::sqrt(std::max(0.0, (1 - y) * (1 + y))), x = r * std::sin(phi), z = -r * std::cos(phi);
    return axes_[0] * float(x) + axes_[1] * float(y) + axes_[2] * float(z);
}

double EnvironmentMap::picturePdf(const Place& p) const {
    if (p.outside || rows_.size() == 0) return 0;
    const double cell = rows_.probability(size_t(p.row)) * columns_[size_t(p.row)].probability(size_t(p.column));
    return (1 - sunShare_) * (cell / cellSolidAngle(p.row));
}

double EnvironmentMap::sunPdf(const Vec3f& w) const {
    return sun_ && sun_->holds(w) ? sunShare_ / sun_->solidAngle() : 0;
}

double EnvironmentMap::pdf(const Vec3f& w) const { return picturePdf(place(w)) + sunPdf(w); }

Sample2 EnvironmentMap::invert(const Vec3f& w, double choice) const {
    const Place p = place(w);
    if (const double sun = sunPdf(w); sun > 0 && choice * (sun + picturePdf(p)) < sun) {
        const Sample2 s = sun_->invert(w);
        return {sunShare_ * s.u, s.v};
    }
    const double high = cosineOfRow(p.row), low = cosineOfRow(p.row + 1);
    const double u = rows_.invert(size_t(p.row), std::clamp((high - p.cosTheta) / (high - low), 0.0, 1.0));
    return {sunShare_ + (1 - sunShare_) * u,
            columns_[size_t(p.row)].invert(size_t(p.column), std::clamp(p.along, 0.0, 1.0))};
}

}  // namespace ulam
