#include "core/scene/environment_map.h"

namespace ulam {

EnvironmentMap::EnvironmentMap(Image image, double scale, const std::array<Vec3f, 3>& axes) : image_(std::move(image)), axes_(axes) {
    for (Rgb& p : image_.pixels) p *= float(scale);
    std::vector<double> rows, cells(size_t(image_.width));
    for (int j = 0; j + 1 < image_.height; ++j) {
        // ∫ over the cell of what grows linearly with θ from the upper row to the lower one, and of the rest.
        const double step = kPi / (image_.height - 1), all = cellSolidAngle(j);
        const double lower = 2 * kPi / image_.width * ((std::sin((j + 1) * step) - std::sin(j * step)) / step - cosineOfRow(j + 1));
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
}

double EnvironmentMap::cellSolidAngle(int row) const {
    return 2 * kPi / image_.width * (cosineOfRow(row) - cosineOfRow(row + 1));
}

EnvironmentMap::Place EnvironmentMap::place(const Vec3f& w) const {
    const double x = dot(w, axes_[0]), y = dot(w, axes_[1]), z = dot(w, axes_[2]);
    double column = inverseAzimuth(-z, x) * image_.width - 0.5;
    if (column < 0) column += image_.width;
    // Near the poles only x and z know how near.
    const double row = std::atan2(std::hypot(x, z), y) / kPi * (image_.height - 1);
    const int i = std::min(int(column), image_.width - 1), j = std::min(int(row), image_.height - 2);
    return {j, i, row - j, column - i, std::cos(kPi * row / (image_.height - 1))};
}

Spectrum EnvironmentMap::radiance(const Vec3f& w) const {
    const Place p = place(w);
    const Spectrum above = Spectrum(texel(p.row, p.column)) * (1 - p.along) + Spectrum(texel(p.row, p.column + 1)) * p.along;
    const Spectrum below = Spectrum(texel(p.row + 1, p.column)) * (1 - p.along) + Spectrum(texel(p.row + 1, p.column + 1)) * p.along;
    return above * (1 - p.down) + below * p.down;
}

Vec3f EnvironmentMap::sample(double u, double v) const {
    const int row = int(rows_.sample(u)), column = int(columns_[size_t(row)].sample(v));
    const double high = cosineOfRow(row), low = cosineOfRow(row + 1), y = high + u * (low - high);
    const double phi = 2 * kPi * (column + 0.5 + v) / image_.width;
    const double r = std::sqrt(std::max(0.0, (1 - y) * (1 + y))), x = r * std::sin(phi), z = -r * std::cos(phi);
    return axes_[0] * float(x) + axes_[1] * float(y) + axes_[2] * float(z);
}

double EnvironmentMap::pdf(const Vec3f& w) const {
    const Place p = place(w);
    return rows_.probability(size_t(p.row)) * columns_[size_t(p.row)].probability(size_t(p.column)) / cellSolidAngle(p.row);
}

Sample2 EnvironmentMap::invert(const Vec3f& w) const {
    const Place p = place(w);
    const double high = cosineOfRow(p.row), low = cosineOfRow(p.row + 1);
    return {rows_.invert(size_t(p.row), std::clamp((high - p.cosTheta) / (high - low), 0.0, 1.0)),
            columns_[size_t(p.row)].invert(size_t(p.column), std::clamp(p.along, 0.0, 1.0))};
}

}  // namespace ulam
