#include "experiments/scenes/apertures.h"

#include "core/base/random.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

/// Irradiance by a disc of radius r and radiance 1 in a parallel plane at distance d, its axis h aside (scenes of the
/// hard-scene library; Howell's catalogue, B-13).
double discIrradiance(double d, double h, double r) {
    const double s = d * d + h * h;
    return kPi / 2 * (1 - (s - r * r) / std::sqrt((s + r * r) * (s + r * r) - 4 * r * r * h * h));
}

double areaOf(const Polygon& polygon) {
    double area = 0;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const Imath::V2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        area += (p.x * q.y - p.y * q.x) / 2;
    }
    return area;
}

bool isInside(const Polygon& polygon, const Imath::V2d& point) {
    for (size_t i = 0; i < polygon.size(); ++i) {
        const Imath::V2d a = polygon[i] - point, b = polygon[(i + 1) % polygon.size()] - point;
        if (a.x * b.y - a.y * b.x < 0) return false;
    }
    return true;
}

}  // namespace

TEST_CASE("a regular polygon has its area and is counter-clockwise") {
    for (const int sides : {3, 4, 7, 64, 512}) CHECK(areaOf(regularPolygon({3, -2}, 0.7, sides, 0.3)) == Approx(0.7));
    for (const Imath::V2d& p : regularPolygon({0, 0}, 4, 4, kPi / 4)) CHECK(std::abs(p.x) == Approx(1));
}

TEST_CASE("Lambert's formula on many-sided polygons is the formula for a disc") {
    for (const double r : {0.01, 0.1, 2.0})
        for (const double h : {0.0, 0.05, 0.3, 5.0})
            for (const double d : {0.05, 0.4, 3.0}) {
                const Polygon disc = regularPolygon({h, 0}, kPi * r * r, 4096, 0.1);
                CHECK(lambertIrradiance(disc, d) == Approx(discIrradiance(d, h, r)).epsilon(1e-5));
            }
}

TEST_CASE("Lambert's formula on few-sided polygons: differential form factors of a square") {
    // Element below the centre of a square of side 2a at distance c (Howell's catalogue, B-4, four quarters).
    for (const double c : {0.01, 0.3, 1.0, 20.0}) {
        const double a = 0.5, root = std::sqrt(a * a + c * c);
        const double factor = 4 / (2 * kPi) * 2 * (a / root) * std::atan(a / root);
        CHECK(lambertIrradiance(regularPolygon({0, 0}, 1, 4, kPi / 4), c) == Approx(kPi * factor).epsilon(1e-10));
    }
    CHECK(lambertIrradiance({}, 1) == 0);
}

TEST_CASE("intersections of convex polygons") {
    const Polygon square = regularPolygon({0, 0}, 4, 4, kPi / 4);
    const auto shifted = [&](double x, double y, double area) { return regularPolygon({x, y}, area, 4, kPi / 4); };
    CHECK(areaOf(intersection(shifted(1, 0.5, 4), square)) == Approx(1.5));
    CHECK(areaOf(intersection(shifted(0.2, 0.2, 0.25), square)) == Approx(0.25));
    CHECK(areaOf(intersection(square, shifted(0, 0, 0.25))) == Approx(0.25));
    CHECK(areaOf(intersection(shifted(3, 0, 4), square)) == 0);
    // A square and the same turned by 45° share a regular octagon.
    CHECK(areaOf(intersection(regularPolygon({0, 0}, 4, 4, 0), square)) == Approx(8 * (std::sqrt(2.0) - 1)));
}

TEST_CASE("light through a thick hole agrees with counting lines of sight") {
    constexpr double kDistance = 0.4, kThickness = 0.1;
    constexpr int kPoints = 200000;
    for (const int sides : {4, 5, 32}) {
        const Hole hole{regularPolygon({0, 0}, 0.002, sides, 0.2), kThickness};
        const double radius = hole.outline[0].length();
        for (const double offset : {0.0, 0.05, 0.1, 0.17}) {
            const Imath::V2d point(offset, 0.03);
            Random random({11, 12}, uint32_t(sides), uint64_t(offset * 1000));
            double sum = 0, sum2 = 0;
            for (int i = 0; i < kPoints; ++i) {
                const Imath::V2d exit((2 * random() - 1) * radius, (2 * random() - 1) * radius);
                const Imath::V2d entrance = point + (exit - point) * ((kDistance + kThickness) / kDistance);
                if (!isInside(hole.outline, exit) || !isInside(hole.outline, entrance)) continue;
                const double d2 = (exit - point).dot(exit - point) + kDistance * kDistance;
                const double f = 4 * radius * radius * kDistance * kDistance / (d2 * d2);
                sum += f, sum2 += f * f;
            }
            const double mean = sum / kPoints, error = std::sqrt((sum2 / kPoints - mean * mean) / kPoints);
            INFO("sides " << sides << " offset " << offset);
            CHECK(std::abs(hole.irradiance(point, kDistance) - mean) <= 5 * error);
            if (std::hypot(offset, 0.03) > hole.reach(kDistance)) CHECK(hole.irradiance(point, kDistance) == 0);
        }
    }
}

TEST_CASE("integrals of functions with kinks and of small spots") {
    const auto kink = [](double x, double y) { return std::max(0.0, x + y / 3 - 0.2); };
    double exact = 0;  // by rows, each of which is a parabola's area
    constexpr int kRows = 100000;
    for (int i = 0; i < kRows; ++i) {
        const double start = std::max(0.0, 0.2 - (i + 0.5) / kRows / 3), from = start + (i + 0.5) / kRows / 3 - 0.2;
        const double to = 1 + (i + 0.5) / kRows / 3 - 0.2;
        exact += (to * to - from * from) / 2 / kRows;
    }
    CHECK(integrate(kink, 0, 1, 0, 1, 1e-8, 0.1) == Approx(exact).margin(1e-6));
    const auto spot = [](double x, double y) {
        return std::max(0.0, 1 - 1e4 * ((x - 0.3) * (x - 0.3) + (y - 0.6) * (y - 0.6)));
    };
    CHECK(integrate(spot, 0, 1, 0, 1, 1e-8, 0.005) == Approx(kPi / 2 * 1e-4).epsilon(1e-3));
}
