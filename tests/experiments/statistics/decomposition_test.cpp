#include "experiments/statistics/decomposition.h"

#include <vector>

#include "core/base/error.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/support/catch.h"

using namespace ulam::statistics;
using namespace ulam::statistics::simulation;

namespace {

using Image = std::vector<float>;

Image noisyImage(std::size_t size, double mean, double sigma, PhiloxStream& random) {
    Image image;
    for (double x : normals(size, random)) image.push_back(static_cast<float>(mean + sigma * x));
    return image;
}

Decomposition decomposeImages(const std::vector<Image>& images, const Image& reference, const Image& variance) {
    return decompose(std::vector<std::span<const float>>(images.begin(), images.end()), reference, variance);
}

}  // namespace

TEST_CASE("variance and squared bias match hand calculation") {
    // One pixel: replicates 1, 2, 3 against 5: variance 1, bias² = 9 - 1/3 - 0.5.
    const Decomposition d = decomposeImages({{1, 7, 7}, {2, 7, 7}, {3, 7, 7}}, {5, 7, 7}, {0.5F, 0, 0});
    CHECK(d.variance == Approx(1.0 / 3));
    CHECK(d.biasSquared == Approx((9 - 1.0 / 3 - 0.5) / 3));
}

TEST_CASE("variance and squared bias add up to the debiased mean squared error") {
    PhiloxStream random(121);
    std::vector<Image> images;
    for (int r = 0; r < 5; ++r) images.push_back(noisyImage(300, 1, 0.5, random));
    const Image reference = noisyImage(300, 1.2, 0.1, random);
    const Image variance(300, 0.01F);
    double squares = 0;
    for (const Image& image : images) {
        for (std::size_t i = 0; i < image.size(); ++i) {
            squares += (double(image[i]) - reference[i]) * (double(image[i]) - reference[i]) - variance[i];
        }
    }
    CHECK(decomposeImages(images, reference, variance).error() == Approx(squares / (5 * 300)).epsilon(1e-12));
}

TEST_CASE("variance and squared bias are unbiased for a noisy reference") {
    PhiloxStream random(122);
    const std::size_t size = 200'000;
    std::vector<Image> images;
    for (int r = 0; r < 4; ++r) images.push_back(noisyImage(size, 1.1, 0.5, random));
    const Image reference = noisyImage(size, 1, 0.2, random);
    const Image variance(size, 0.04F);
    const Decomposition d = decomposeImages(images, reference, variance);
    CHECK(d.variance == Approx(0.25).epsilon(0.01));
    CHECK(d.biasSquared == Approx(0.01).margin(0.001));  // standard error 0.0003
    std::vector<Image> right;
    for (int r = 0; r < 4; ++r) right.push_back(noisyImage(size, 1, 0.5, random));
    CHECK(decomposeImages(right, reference, variance).biasSquared == Approx(0).margin(0.001));
}

TEST_CASE("images that do not fit are refused") {
    const Image image(3, 1.0F);
    CHECK_THROWS_AS(decomposeImages({image}, image, {}), ulam::Error);
    CHECK_THROWS_AS(decomposeImages({image, Image(6)}, image, {}), ulam::Error);
    CHECK_THROWS_AS(decomposeImages({image, image}, image, Image(2)), ulam::Error);
    CHECK(decomposeImages({image, image}, image, {}).error() == 0);
}
