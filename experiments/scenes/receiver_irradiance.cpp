#include "experiments/scenes/receiver_irradiance.h"

namespace ulam {

ReceiverIrradiance::ReceiverIrradiance(const HolePlate& plate, double distance) : distance_(distance) {
    for (int row = 0; row < plate.holes; ++row)
        for (int column = 0; column < plate.holes; ++column) {
            const Hole hole{plate.outline(row, column), plate.thickness};
            places_.push_back({hole, plate.axis(row, column), hole.reach(distance), hole.irradiance({0, 0}, distance),
                               hole.outline.size() % 4 == 0});
        }
}

size_t ReceiverIrradiance::KeyHash::operator()(const Key& key) const {
    uint64_t hash = 0;
    for (const long long part : key) hash = (hash ^ uint64_t(part)) * 0x9e3779b97f4a7c15ull, hash ^= hash >> 29;
    return size_t(hash);
}

double ReceiverIrradiance::mean(size_t hole, const ReceiverView::Square& square) {
    const Place& place = places_[hole];
    double x0 = square.x0 - place.axis.x, x1 = square.x1 - place.axis.x;
    double y0 = square.y0 - place.axis.y, y1 = square.y1 - place.axis.y;
    const double nearX = std::max({x0, -x1, 0.0}), nearY = std::max({y0, -y1, 0.0});
    if (nearX * nearX + nearY * nearY > place.reach * place.reach) return 0;
    if (place.mirrorSymmetric) {
        if (x0 + x1 < 0) std::tie(x0, x1) = std::pair(-x1, -x0);
        if (y0 + y1 < 0) std::tie(y0, y1) = std::pair(-y1, -y0);
    }
    const auto rounded = [](double x) { return std::llround(x * 0x1p40); };
    const Key key{rounded(x0), rounded(x1), rounded(y0), rounded(y1), rounded(place.hole.outline[0].length())};
    const auto [known, isNew] = known_.try_emplace(key);
    if (isNew) known->second = integral(place, x0, x1, y0, y1) / ((x1 - x0) * (y1 - y0));
    return known->second;
}

double ReceiverIrradiance::integral(const Place& place, double x0, double x1, double y0, double y1) const {
    constexpr double kTolerance = 1e-5;
    const auto irradiance = [&](double x, double y) { return place.hole.irradiance({x, y}, distance_); };
    // Not so coarse that the nodes miss a small spot.
    const double largestCell = std::min(place.reach, distance_) / 2;
    return integrate(irradiance, x0, x1, y0, y1, kTolerance * place.peak * (x1 - x0) * (y1 - y0), largestCell);
}

}  // namespace ulam
