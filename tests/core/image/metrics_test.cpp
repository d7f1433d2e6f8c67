#include "core/image/metrics.h"

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "core/base/error.h"
#include "core/image/srgb.h"
#include "tests/support/catch.h"

using namespace ulam;

namespace {

Image row(const std::vector<Rgb>& pixels) {
    Image image(static_cast<int>(pixels.size()), 1);
    image.pixels = pixels;
    return image;
}

double evaluate(const char* name, const Image& image, const Image& reference, const Image* variance = nullptr) {
    return findMetric(name).evaluate(image, reference, variance);
}

/// A smooth picture of a size that no filter divides.
Image smooth() {
    Image image(37, 23);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            image.at(x, y) = Rgb(0.5f + 0.4f * std::sin(0.3f * float(x)), 0.01f * float(x) + 0.02f * float(y), 0.3f);
        }
    }
    return image;
}

}  // namespace

TEST_CASE("metrics follow their definitions on two pixels") {
    const Image reference = row({Rgb(1, 0, 2), Rgb(0.5f, 0.5f, 0.5f)});
    const Image image = row({Rgb(1.5f, 0.1f, 1), Rgb(0.5f, 0, 1)});
    // Errors: 0.5, 0.1, -1; 0, -0.5, 0.5.
    const double mse = (0.25 + 0.01 + 1 + 0 + 0.25 + 0.25) / 6;
    CHECK(evaluate("mse", image, reference) == Approx(mse));
    CHECK(evaluate("mae", image, reference) == Approx((0.5 + 0.1 + 1 + 0 + 0.5 + 0.5) / 6));
    CHECK(evaluate("relmse", image, reference) ==
          Approx((0.25 / 1.01 + 0.01 / 0.01 + 1 / 4.01 + 0 + 0.25 / 0.26 + 0.25 / 0.26) / 6));
    CHECK(evaluate("mape", image, reference) ==
          Approx((0.5 / 1.01 + 0.1 / 0.01 + 1 / 2.01 + 0 + 0.5 / 0.51 + 0.5 / 0.51) / 6));
    CHECK(evaluate("smape", image, reference) ==
          Approx((0.5 / 2.51 + 0.1 / 0.11 + 1 / 3.01 + 0 + 0.5 / 0.51 + 0.5 / 1.51) / 6));
    CHECK(evaluate("psnr", image, reference) == Approx(-10 * std::log10(mse)));

    const auto map = findMetric("mse").errorMap(image, reference);
    REQUIRE(map.size() == 2);
    CHECK(map[0] == Approx(1.26 / 3));
    CHECK(map[1] == Approx(0.5 / 3));
}

TEST_CASE("the variance of the reference is subtracted where a metric says so, and only there") {
    const Image reference = row({Rgb(1, 2, 0)}), image = row({Rgb(2, 2, 1)}), variance = row({Rgb(0.1f, 0.2f, 0.3f)});
    CHECK(evaluate("mse", image, reference, &variance) == Approx((2 - 0.6) / 3));
    CHECK(evaluate("relmse", image, reference, &variance) == Approx((0.9 / 1.01 - 0.2 / 4.01 + 0.7 / 0.01) / 3));
    for (const Metric& metric : metrics()) {
        CAPTURE(metric.name);
        const bool changes = metric.evaluate(image, reference, &variance) != metric.evaluate(image, reference);
        CHECK(changes == metric.debiased);
    }
}

TEST_CASE("against a noisy reference the debiased mse has the expectation of the true one") {
    // Truth 1, image 1.2 everywhere: the true mse is 0.04. The reference is a mean of 4 normal replicates of deviation
    // 0.4, its variance is estimated from the same 4. 400 references of 300 values; a z-test at level 1e-4 (3.89).
    const Image image(10, 10, Rgb(1.2f));
    std::mt19937 generator(7);
    std::normal_distribution<double> noise(1, 0.4);
    double sum = 0, sumOfSquares = 0, undebiased = 0;
    constexpr int kRuns = 400, kReplicates = 4;
    for (int run = 0; run < kRuns; ++run) {
        Image reference(10, 10), variance(10, 10);
        for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
            for (int c = 0; c < 3; ++c) {
                double s = 0, ss = 0;
                for (int k = 0; k < kReplicates; ++k) {
                    const double v = noise(generator);
                    s += v;
                    ss += v * v;
                }
                const double mean = s / kReplicates;
                reference.pixels[i][c] = static_cast<float>(mean);
                variance.pixels[i][c] = static_cast<float>((ss - s * mean) / (kReplicates - 1) / kReplicates);
            }
        }
        const double mse = evaluate("mse", image, reference, &variance);
        sum += mse;
        sumOfSquares += mse * mse;
        undebiased += evaluate("mse", image, reference);
    }
    const double mean = sum / kRuns;
    const double standardError = std::sqrt((sumOfSquares / kRuns - mean * mean) / (kRuns - 1));
    CHECK(std::abs(mean - 0.04) < 3.89 * standardError);
    CHECK(standardError < 0.001);  // the test can tell 0.04 from the undebiased expectation 0.08
    CHECK(undebiased / kRuns == Approx(0.08).epsilon(0.03));
}

TEST_CASE("an image equals itself in every metric") {
    const Image image = smooth();
    for (const Metric& metric : metrics()) {
        CAPTURE(metric.name);
        for (const double error : metric.errorMap(image, image)) REQUIRE(std::abs(error) < 1e-12);
    }
    CHECK(evaluate("ssim", image, image) == Approx(1).margin(1e-12));
    CHECK(evaluate("psnr", image, image) == std::numeric_limits<double>::infinity());
}

TEST_CASE("every metric prefers the better of two images") {
    const Image reference = smooth();
    Image good = reference, bad = reference;
    std::mt19937 generator(3);
    std::uniform_real_distribution<float> noise(0.0f, 0.1f);
    for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
        const float n = noise(generator);
        good.pixels[i] += Rgb(n);
        bad.pixels[i] += Rgb(3 * n);
    }
    for (const Metric& metric : metrics()) {
        CAPTURE(metric.name);
        const double better = metric.evaluate(good, reference), worse = metric.evaluate(bad, reference);
        CHECK((metric.higherIsBetter ? better > worse : better < worse));
    }
}

TEST_CASE("ssim of constant images is the luminance term, also at the border and in tiny images") {
    // No variance on either side: SSIM = (2 a b + c1) / (a^2 + b^2 + c1).
    const double a = linearToSrgb(0.2), b = linearToSrgb(0.6), c1 = 0.01 * 0.01;
    const double expected = (2 * a * b + c1) / (a * a + b * b + c1);
    for (const auto& [width, height] : {std::pair{30, 20}, {3, 2}, {1, 1}}) {
        const Image x(width, height, Rgb(0.2f)), y(width, height, Rgb(0.6f));
        for (const double error : findMetric("ssim").errorMap(x, y)) {
            REQUIRE(1 - error == Approx(expected).epsilon(1e-6));
        }
    }
}

TEST_CASE("ssim at a pixel is the formula over its 11 x 11 window") {
    const Image x = smooth();
    Image y = x;
    for (std::size_t i = 0; i < y.pixels.size(); ++i) y.pixels[i] *= (i % 3 == 0) ? 0.7f : 1.1f;
    const int centreX = 17, centreY = 11;
    double total = 0, mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
    for (int dy = -5; dy <= 5; ++dy) {
        for (int dx = -5; dx <= 5; ++dx) {
            const double weight = std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5));
            const auto shown = [&](const Image& image) {
                return linearToSrgb(std::min(1.0, luminance(Spectrum(image.at(centreX + dx, centreY + dy)))));
            };
            const double p = shown(x), q = shown(y);
            total += weight;
            mx += weight * p;
            my += weight * q;
            xx += weight * p * p;
            yy += weight * q * q;
            xy += weight * p * q;
        }
    }
    for (double* v : {&mx, &my, &xx, &yy, &xy}) *v /= total;
    const double c1 = 1e-4, c2 = 9e-4;
    const double expected = (2 * mx * my + c1) * (2 * (xy - mx * my) + c2) /
                            ((mx * mx + my * my + c1) * (xx - mx * mx + yy - my * my + c2));
    const auto map = findMetric("ssim").errorMap(x, y);
    CHECK(1 - map[centreY * x.width + centreX] == Approx(expected).epsilon(1e-9));
    CHECK(expected < 0.99);
}

TEST_CASE("trimmed values leave out one pixel in a thousand, the worst ones") {
    Image reference(50, 40, Rgb(0.5f)), image(50, 40, Rgb(0.6f));
    image.at(3, 4) = image.at(40, 30) = Rgb(1e4f);  // 2 of 2000 pixels
    const Metric& mse = findMetric("mse");
    const auto map = mse.errorMap(image, reference);
    CHECK(mse.value(map) > 1e4);
    CHECK(mse.trimmedValue(map) == Approx(0.01).epsilon(1e-5));
    const Metric& psnr = findMetric("psnr");
    CHECK(psnr.trimmedValue(psnr.errorMap(image, reference)) == Approx(20).epsilon(1e-5));

    image.at(7, 7) = Rgb(10);  // a third one stays
    CHECK(mse.trimmedValue(mse.errorMap(image, reference)) > 0.04);
    // Below a thousand pixels none is left out.
    const Image small = row({Rgb(0), Rgb(100)}), zero = row({Rgb(0), Rgb(0)});
    CHECK(mse.trimmedValue(mse.errorMap(small, zero)) == mse.evaluate(small, zero));
}

TEST_CASE("errors of any finite image are finite") {
    const Image huge = row({Rgb(3e38f)}), zero = row({Rgb(0)});
    for (const Metric& metric : metrics()) {
        CAPTURE(metric.name);
        CHECK(std::isfinite(metric.evaluate(huge, zero)));
        CHECK(std::isfinite(metric.evaluate(zero, huge)));
    }
}

TEST_CASE("the table names each metric once, with a definition and its constants") {
    std::set<std::string_view> names;
    for (const Metric& metric : metrics()) {
        names.insert(metric.name);
        CHECK_FALSE(metric.definition.empty());
        CHECK(&findMetric(metric.name) == &metric);
    }
    CHECK(names == std::set<std::string_view>{"mse", "mae", "relmse", "mape", "smape", "psnr", "ssim", "flip"});
    REQUIRE(findMetric("relmse").constants.size() == 1);
    CHECK(findMetric("relmse").constants[0].name == "epsilon");
    CHECK(findMetric("relmse").constants[0].value == 0.01);
}

TEST_CASE("metrics refuse unknown names and images of different size") {
    const auto message = [](auto action) -> std::string {
        try {
            action();
        } catch (const Error& error) {
            CHECK(error.code() == ExitCode::InvalidConfig);
            return error.what();
        }
        return "";
    };
    const auto mentions = [](const std::string& text, const char* part) {
        return text.find(part) != std::string::npos;
    };
    const std::string unknown = message([] { findMetric("rmse"); });
    CHECK(mentions(unknown, "\"rmse\""));
    CHECK(mentions(unknown, "relmse"));

    const Image a(2, 3), b(3, 2), empty;
    const std::string sizes = message([&] { evaluate("mse", a, b); });
    CHECK(mentions(sizes, "2 x 3"));
    CHECK(mentions(sizes, "3 x 2"));
    CHECK_THROWS_AS(evaluate("mse", a, a, &b), Error);
    CHECK_THROWS_AS(evaluate("flip", empty, empty), Error);

    Image variance(2, 2);
    CHECK(message([&] { requireVariance(variance, "v.exr"); }).empty());
    for (const float bad : {-1e-9f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        variance.at(1, 0) = Rgb(0, bad, 0);
        const std::string refused = message([&] { requireVariance(variance, "v.exr"); });
        CHECK(mentions(refused, "v.exr"));
        CHECK(mentions(refused, "(1, 0)"));
    }
}
