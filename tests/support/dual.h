#pragma once
// The smallest dual number: a value and its derivative with respect to one parameter.

#include <cmath>
#include <numbers>

namespace ulam {

struct Dual {
    double v = 0, d = 0;

    constexpr Dual() = default;
    constexpr Dual(double value) : v(value) {}
    constexpr Dual(double value, double derivative) : v(value), d(derivative) {}

    explicit operator double() const { return v; }

    Dual operator-() const { return {-v, -d}; }
    friend Dual operator+(Dual a, Dual b) { return {a.v + b.v, a.d + b.d}; }
    friend Dual operator-(Dual a, Dual b) { return {a.v - b.v, a.d - b.d}; }
    friend Dual operator*(Dual a, Dual b) { return {a.v * b.v, a.d * b.v + a.v * b.d}; }
    friend Dual operator/(Dual a, Dual b) { return {a.v / b.v, (a.d - a.v / b.v * b.d) / b.v}; }
    friend bool operator<(Dual a, Dual b) { return a.v < b.v; }
    friend bool operator>(Dual a, Dual b) { return a.v > b.v; }
    friend bool operator==(Dual a, Dual b) { return a.v == b.v; }
};

inline Dual sqrt(Dual a) {
    return {std::sqrt(a.v), a.d / (2 * std::sqrt(a.v))};
}
inline Dual exp(Dual a) {
    return {std::exp(a.v), a.d * std::exp(a.v)};
}
inline Dual log(Dual a) {
    return {std::log(a.v), a.d / a.v};
}
inline Dual erf(Dual a) {
    return {std::erf(a.v), a.d * 2 * std::numbers::inv_sqrtpi * std::exp(-a.v * a.v)};
}
inline Dual atan2(Dual y, Dual x) {
    return {std::atan2(y.v, x.v), (x.v * y.d - y.v * x.d) / (x.v * x.v + y.v * y.v)};
}
inline Dual abs(Dual a) {
    return a.v < 0 ? -a : a;
}

}  // namespace ulam
