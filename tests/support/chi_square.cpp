#include "tests/support/chi_square.h"

#include <fmt/format.h>

#include <numeric>

#include "experiments/statistics/goodness_of_fit.h"

namespace ulam {
namespace {

// Midpoints a cell and axis for the integral of the density over the cell.
constexpr int kMidpoints = 16;
// What that quadrature may be off by, over the whole domain.
constexpr double kQuadratureError = 1e-3;

std::optional<std::string> judge(std::span<const double> observed, std::span<const double> expected) {
    const auto test = statistics::chiSquareTest(observed, expected);
    if (test.p > suiteThreshold()) return {};
    return fmt::format("chi-square {:.6g} with {} degrees of freedom, p = {:.3g}, below {:.3g}", test.statistic,
                       test.degrees, test.p, suiteThreshold());
}

}  // namespace

double suiteThreshold() {
    return -std::expm1(std::log1p(-1e-6) / kSuiteTests);
}

Sample2 azimuthAndZ(const Vec3f& w) {
    return {std::atan2(double(w.y), double(w.x)), std::clamp(double(w.z), -1.0, 1.0)};
}

Vec3f directionOf(double azimuth, double z) {
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {float(r * std::cos(azimuth)), float(r * std::sin(azimuth)), float(z)};
}

std::optional<std::string> misfit(const Domain& d, const std::function<std::optional<Sample2>(Random&)>& sample,
                                  const std::function<double(double, double)>& density, uint64_t seed, int samples) {
    const auto cells = size_t(d.columns * d.rows);
    std::vector<double> observed(cells + 1, 0), expected(cells + 1, 0);
    Random random(makeKey(seed), 0, 0);
    for (int i = 0; i < samples; ++i) {
        const auto s = sample(random);
        if (!s) {
            ++observed[cells];
            continue;
        }
        const double x = (s->u - d.x0) / (d.x1 - d.x0), y = (s->v - d.y0) / (d.y1 - d.y0);
        if (!(x >= -1e-6 && x <= 1 + 1e-6 && y >= -1e-6 && y <= 1 + 1e-6))
            return fmt::format("the sample ({}, {}) lies outside the domain", s->u, s->v);
        const int column = std::clamp(int(x * d.columns), 0, d.columns - 1),
                  row = std::clamp(int(y * d.rows), 0, d.rows - 1);
        ++observed[size_t(row * d.columns + column)];
    }
    const double width = (d.x1 - d.x0) / (d.columns * kMidpoints), height = (d.y1 - d.y0) / (d.rows * kMidpoints);
    for (int row = 0; row < d.rows; ++row)
        for (int column = 0; column < d.columns; ++column) {
            double sum = 0;
            for (int j = 0; j < kMidpoints; ++j)
                for (int i = 0; i < kMidpoints; ++i)
                    sum += density(d.x0 + (column * kMidpoints + i + 0.5) * width,
                                   d.y0 + (row * kMidpoints + j + 0.5) * height);
            double& cell = expected[size_t(row * d.columns + column)];
            cell = sum * width * height * samples;
            // Where the density's support covers a corner between the midpoints only, a few samples may come all the
            // same.
            for (int n = 0; n <= kMidpoints && cell == 0; ++n) {
                const double x0 = d.x0 + column * kMidpoints * width, y0 = d.y0 + row * kMidpoints * height;
                const double x1 = x0 + kMidpoints * width, y1 = y0 + kMidpoints * height;
                if (density(x0 + n * width, y0) + density(x0 + n * width, y1) + density(x0, y0 + n * height) +
                        density(x1, y0 + n * height) >
                    0)
                    cell = 1e-3;
            }
        }
    const double integral = std::accumulate(expected.begin(), expected.end(), 0.0) / samples;
    const double found = 1 - observed[cells] / samples;
    if (std::abs(integral - found) > kQuadratureError + 5 * std::sqrt(found * (1 - found) / samples))
        return fmt::format("the density integrates to {:.6g}, but a fraction of {:.6g} of the samples is found",
                           integral, found);
    // Where every sample is found the density is one of the whole; else the missed ones are a cell of their own.
    if (observed[cells] == 0)
        for (double& e : expected) e /= integral;
    else
        expected[cells] = (1 - integral) * samples;
    return judge(observed, expected);
}

std::optional<std::string> misfit(std::span<const double> observed, std::span<const double> probabilities) {
    const double total = std::accumulate(observed.begin(), observed.end(), 0.0);
    std::vector<double> expected;
    for (const double p : probabilities) expected.push_back(p * total);
    return judge(observed, expected);
}

}  // namespace ulam
