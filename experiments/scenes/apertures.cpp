#include "experiments/scenes/apertures.h"

#include <limits>

namespace ulam {
namespace {

/// Up to here the series of arcsine is exact to 1e-12.
constexpr double kSmallSine2 = 0.0025;

double cross2(const Imath::V2d& a, const Imath::V2d& b) {
    return a.x * b.y - a.y * b.x;
}

/// What of a polygon lies left of the line from a to b.
void clip(const Polygon& polygon, const Imath::V2d& a, const Imath::V2d& b, Polygon& result) {
    result.clear();
    const Imath::V2d direction = b - a;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const Imath::V2d &p = polygon[i], &q = polygon[i + 1 < polygon.size() ? i + 1 : 0];
        const double dp = cross2(direction, p - a), dq = cross2(direction, q - a);
        if (dp >= 0) result.push_back(p);
        if ((dp >= 0) != (dq >= 0)) result.push_back(p + (q - p) * (dp / (dp - dq)));
    }
}

bool isLeftOf(const Polygon& polygon, const Imath::V2d& a, const Imath::V2d& b) {
    const Imath::V2d direction = b - a;
    double least = 0;
    for (const Imath::V2d& p : polygon) least = std::min(least, cross2(direction, p - a));
    return least >= 0;
}

double integrateCell(const std::function<double(double, double)>& f, double x0, double x1, double y0, double y1,
                     double tolerance, double largestCell, int depth) {
    constexpr double kTwo = 0.57735026918962576451, kThree = 0.77459666924148337704;  // Gauss–Legendre nodes
    constexpr int kDeepest = 12;
    const double mx = (x0 + x1) / 2, my = (y0 + y1) / 2, hx = (x1 - x0) / 2, hy = (y1 - y0) / 2;
    if (2 * hx <= largestCell && 2 * hy <= largestCell) {
        double two = 0, three = 0;
        for (const double y : {-kTwo, kTwo})
            for (const double x : {-kTwo, kTwo}) two += f(mx + x * hx, my + y * hy) / 4;
        for (const double y : {-kThree, 0.0, kThree})
            for (const double x : {-kThree, 0.0, kThree})
                three += f(mx + x * hx, my + y * hy) * (x == 0 ? 8 : 5) * (y == 0 ? 8 : 5) / 324;
        const double area = 4 * hx * hy;
        if (std::abs(two - three) * area <= tolerance || depth == kDeepest) return three * area;
    }
    const auto quarter = [&](double a0, double a1, double b0, double b1) {
        return integrateCell(f, a0, a1, b0, b1, tolerance / 2, largestCell, depth + 1);
    };
    return quarter(x0, mx, y0, my) + quarter(mx, x1, y0, my) + quarter(x0, mx, my, y1) + quarter(mx, x1, my, y1);
}

}  // namespace

Polygon regularPolygon(const Imath::V2d& center, double area, int sides, double phase) {
    const double step = 2 * kPi / sides, radius = std::sqrt(2 * area / (sides * std::sin(step)));
    Polygon polygon;
    for (int i = 0; i < sides; ++i)
        polygon.push_back(center + Imath::V2d(std::cos(phase + i * step), std::sin(phase + i * step)) * radius);
    return polygon;
}

Polygon intersection(Polygon subject, const Polygon& window) {
    Polygon clipped;
    for (size_t i = 0; i < window.size() && !subject.empty(); ++i) {
        const Imath::V2d &a = window[i], &b = window[i + 1 < window.size() ? i + 1 : 0];
        if (isLeftOf(subject, a, b)) continue;
        clip(subject, a, b, clipped);
        subject.swap(clipped);
    }
    return subject;
}

double lambertIrradiance(const Polygon& polygon, double distance) {
    const size_t n = polygon.size();
    const auto inverseLength = [&](size_t i) {
        return 1 / std::sqrt(polygon[i].dot(polygon[i]) + distance * distance);
    };
    double sum = 0, last = n > 0 ? inverseLength(n - 1) : 0;
    for (size_t i = 0, j = n - 1; i < n; j = i++) {
        const Imath::V2d &p = polygon[j], &q = polygon[i];
        const double next = inverseLength(i), cosine = (p.dot(q) + distance * distance) * last * next;
        // An edge adds its angle θ times the normal of its plane through the point; p × q = sin θ |p||q| times that.
        const double sine2 = std::max(0.0, 1 - cosine * cosine);
        const double angleOverSine = cosine > 0 && sine2 < kSmallSine2
                                         ? 1 + sine2 * (1.0 / 6 + sine2 * (3.0 / 40 + sine2 * (15.0 / 336)))
                                         : std::acos(std::clamp(cosine, -1.0, 1.0)) / std::sqrt(sine2);
        sum += cross2(p, q) * last * next * angleOverSine;
        last = next;
    }
    return std::abs(sum) / 2;
}

double Hole::irradiance(const Imath::V2d& point, double distance) const {
    Polygon exit = outline;
    for (Imath::V2d& p : exit) p -= point;
    if (thickness == 0) return lambertIrradiance(exit, distance);
    // The entrance as the point sees it, projected onto the plane of the exit.
    Polygon entrance = exit;
    for (Imath::V2d& p : entrance) p *= distance / (distance + thickness);
    return lambertIrradiance(intersection(std::move(entrance), exit), distance);
}

double Hole::reach(double distance) const {
    if (thickness == 0) return std::numeric_limits<double>::infinity();
    double radius = 0;
    for (const Imath::V2d& p : outline) radius = std::max(radius, p.length());
    return radius * (2 * distance + thickness) / thickness;
}

double integrate(const std::function<double(double, double)>& f, double x0, double x1, double y0, double y1,
                 double tolerance, double largestCell) {
    return integrateCell(f, x0, x1, y0, y1, tolerance, largestCell, 0);
}

}  // namespace ulam
