#include "core/scene/octahedral_map.h"

#include <tuple>

namespace ulam {
namespace {

constexpr int kSubsamples = 4;  // along each side of a texel

const Rgb& nearest(const Image& image, const Sample2& p) {
    return image.at(std::min(int(p.u * image.width), image.width - 1),
                    std::min(int(p.v * image.height), image.height - 1));
}

}  // namespace

Vec3d octahedralDirection(double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1, outside = std::abs(x) + std::abs(y) - 1;
    // The distance from the octant's pole, in both hemispheres.
    const double r = 1 - std::abs(outside);
    const double turn = r > 0 ? ((std::abs(y) - std::abs(x)) / r + 1) * kPi / 4 : 0;
    const double z = std::copysign(1 - r * r, -outside), across = r * std::sqrt(std::max(0.0, 2 - r * r));
    return {std::copysign(across * std::cos(turn), x), std::copysign(across * std::sin(turn), y), z};
}

Sample2 octahedralPoint(const Vec3d& direction) {
    const double r = std::sqrt(std::max(0.0, 1 - std::abs(direction.z)));
    const double turn = std::atan2(std::abs(direction.y), std::abs(direction.x)) * 2 / kPi;
    double x = r * (1 - turn), y = r * turn;
    if (direction.z < 0) std::tie(x, y) = std::pair(1 - y, 1 - x);
    const auto toUnit = [](double value, double sign) {
        return std::clamp((std::copysign(value, sign) + 1) / 2, 0.0, 1.0);
    };
    return {toUnit(x, direction.x), toUnit(y, direction.y)};
}

Image latLongFromOctahedral(const Image& square) {
    const int width = std::max(4, 2 * square.width), height = std::max(3, square.width + 1);
    Image result(width, height);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            Spectrum sum(0.0);
            double weights = 0;
            for (int sj = 0; sj < kSubsamples; ++sj) {
                const double theta = kPi * (j - 0.5 + (sj + 0.5) / kSubsamples) / (height - 1), sine = std::sin(theta);
                if (!(sine > 0)) continue;  // beyond a pole
                for (int si = 0; si < kSubsamples; ++si) {
                    const double phi = 2 * kPi * (i + (si + 0.5) / kSubsamples) / width;
                    const Vec3d w(sine * std::sin(phi), std::cos(theta), -sine * std::cos(phi));
                    sum += Spectrum(nearest(square, octahedralPoint(w))) * sine;
                    weights += sine;
                }
            }
            result.at(i, j) = Rgb(sum / weights);
        }
    return result;
}

Image octahedralFromMap(const EnvironmentMap& map, int size) {
    Image result(size, size);
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) {
            Spectrum sum(0.0);
            for (int sj = 0; sj < kSubsamples; ++sj)
                for (int si = 0; si < kSubsamples; ++si)
                    sum += map.pictureRadiance(Vec3f(octahedralDirection((i + (si + 0.5) / kSubsamples) / size,
                                                                  (j + (sj + 0.5) / kSubsamples) / size)));
            result.at(i, j) = Rgb(sum / (kSubsamples * kSubsamples));
        }
    return result;
}

}  // namespace ulam
