#include "core/image/filter.h"

#include "tests/support/catch.h"

using namespace ulam;

namespace {

/// ∫ f over [a, b] by Simpson's rule.
template <class F>
double simpson(F f, double a, double b) {
    constexpr int kSteps = 20000;
    const double h = (b - a) / kSteps;
    double sum = f(a) + f(b);
    for (int i = 1; i < kSteps; ++i) sum += f(a + i * h) * (i % 2 ? 4 : 2);
    return sum * h / 3;
}

std::vector<ReconstructionFilter> filters() {
    ReconstructionFilter::TentParameters tent;
    tent.radius = 1.75;
    ReconstructionFilter::GaussianParameters wide;
    wide.stddev = 1.2;
    return {ReconstructionFilter(), ReconstructionFilter(ReconstructionFilter::TentParameters()),
            ReconstructionFilter(tent), ReconstructionFilter(ReconstructionFilter::GaussianParameters()),
            ReconstructionFilter(wide)};
}

}  // namespace

TEST_CASE("a filter integrates to 1, is even and ends at its radius") {
    for (const ReconstructionFilter& filter : filters()) {
        const double r = filter.radius(), inside = std::nextafter(r, 0.0);
        CHECK(simpson([&](double x) { return filter(x); }, -inside, inside) == Approx(1).epsilon(1e-7));
        CHECK(simpson([&](double x) { return filter(x) * filter(x); }, -inside, inside) ==
              Approx(filter.squareIntegral()).epsilon(1e-7));
        CHECK(filter(0.3) == Approx(filter(-0.3)));
        CHECK(filter(r * 1.0001) == 0);
        CHECK(filter(-r * 1.0001) == 0);
    }
}

TEST_CASE("samples of a filter have its distribution") {
    for (const ReconstructionFilter& filter : filters()) {
        double last = -filter.radius() - 1e-6;
        for (const double u : {1e-9, 0.001, 0.1, 0.37, 0.5, 0.5000001, 0.8, 0.999, 1 - 1e-9}) {
            const double x = filter.sample(u);
            CHECK(x > last);
            last = x;
            CHECK(std::abs(x) <= filter.radius());
            CHECK(simpson([&](double t) { return filter(t); }, -filter.radius(), x) == Approx(u).margin(2e-6));
        }
    }
}

TEST_CASE("a point on the border of two pixels belongs to one of them") {
    const ReconstructionFilter box;
    CHECK(box(-0.5) + box(0.5) == 1);
}
