#pragma once
// Do samples follow their density? Chi-square on a grid, every test of a suite at one corrected level.

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "core/base/random.h"
#include "core/base/warp.h"
#include "tests/support/catch.h"

namespace ulam {

/// p-values below this reject: level 1e-6 for a suite of at most 400 tests (Šidák).
inline constexpr double kSuiteTests = 400;
double suiteThreshold();

struct Domain {
    double x0, x1, y0, y1;
    int columns = 32, rows = 16;
};
/// Directions as (azimuth, z): solid angle is area there.
inline constexpr Domain kDirections{-3.14159265358979323846, 3.14159265358979323846, -1, 1, 40, 20};
Sample2 azimuthAndZ(const Vec3f& w);
Vec3f directionOf(double azimuth, double z);

/// Draws `samples` points (none: the sampler found nothing) and compares their counts per cell with the integral of the
/// density, which must be defined on the border of the domain too. Returns what is wrong, with statistic and p; nothing if
/// the samples follow the density.
std::optional<std::string> misfit(const Domain& domain, const std::function<std::optional<Sample2>(Random&)>& sample,
                                  const std::function<double(double, double)>& density, uint64_t seed,
                                  int samples = 1'000'000);

/// Counts of categories against their probabilities.
std::optional<std::string> misfit(std::span<const double> observed, std::span<const double> probabilities);

}  // namespace ulam

#define CHECK_FIT(...)                    \
    do {                                  \
        const auto wrong = (__VA_ARGS__); \
        INFO(wrong.value_or(""));         \
        CHECK_FALSE(wrong);               \
    } while (false)
