#include "core/image/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/image/convolution.h"

namespace ulam {
namespace {

struct Color {
    float x, y, z;
};

// ---- colour spaces (2020, section 4.1; D65) ----

// Linear sRGB to XYZ, and the white it takes (1, 1, 1) to.
constexpr std::array<std::array<double, 3>, 3> kToXyz{{
    {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382},
}};
constexpr Color kWhite{0.950428545f, 1.0f, 1.088900371f};

using Matrix = std::array<std::array<float, 3>, 3>;

/// XYZ relative to the white.
constexpr Matrix kToRelativeXyz = [] {
    Matrix m{};
    const double white[3] = {kWhite.x, kWhite.y, kWhite.z};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[i][j] = static_cast<float>(kToXyz[i][j] / white[i]);
    return m;
}();

constexpr Matrix kFromRelativeXyz = [] {
    Matrix inverse{};
    const auto& m = kToXyz;
    const double white[3] = {kWhite.x, kWhite.y, kWhite.z};
    double determinant = 0;
    for (int j = 0; j < 3; ++j) {
        const int k = (j + 1) % 3, l = (j + 2) % 3;
        determinant += m[0][j] * (m[1][k] * m[2][l] - m[1][l] * m[2][k]);
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            const double cofactor = m[a][c] * m[b][d] - m[a][d] * m[b][c];
            inverse[i][j] = static_cast<float>(cofactor / determinant * white[j]);
        }
    }
    return inverse;
}();

Color apply(const Matrix& m, const Color& c) {
    return {m[0][0] * c.x + m[0][1] * c.y + m[0][2] * c.z, m[1][0] * c.x + m[1][1] * c.y + m[1][2] * c.z,
            m[2][0] * c.x + m[2][1] * c.y + m[2][2] * c.z};
}

Color linearToYcxcz(const Color& rgb) {
    const Color v = apply(kToRelativeXyz, rgb);
    return {116 * v.y - 16, 500 * (v.x - v.y), 200 * (v.y - v.z)};
}

Color ycxczToLinear(const Color& c) {
    const float y = (c.x + 16) / 116;
    return apply(kFromRelativeXyz, {y + c.y / 500, y, y - c.z / 200});
}

/// CIELAB with the chroma scaled by the lightness: colours differ less in the dark (Hunt effect).
Color linearToHuntLab(const Color& rgb) {
    const auto f = [](float t) {
        constexpr float kDelta = 6.0f / 29;
        return t > kDelta * kDelta * kDelta ? std::pow(t, 1.0f / 3) : t / (3 * kDelta * kDelta) + 4.0f / 29;
    };
    const Color v = apply(kToRelativeXyz, rgb);
    const float fy = f(v.y), lightness = 116 * fy - 16;
    return {lightness, 0.01f * lightness * 500 * (f(v.x) - fy), 0.01f * lightness * 200 * (fy - f(v.z))};
}

float hyab(const Color& a, const Color& b) {
    return std::abs(a.x - b.x) + std::sqrt((a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

// ---- tone mapping (2021, section 3): the ACES fit of Narkowicz with its exposure of 0.6 taken in ----

constexpr float kAcesA = 0.6f * 0.6f * 2.51f, kAcesB = 0.6f * 0.03f;
constexpr float kAcesC = 0.6f * 0.6f * 2.43f, kAcesD = 0.6f * 0.59f, kAcesE = 0.14f;

float toneMap(float x) {
    x = std::min(x, 1e6f);  // white long before; keeps the squares finite
    return std::clamp((kAcesA * x + kAcesB) * x / ((kAcesC * x + kAcesD) * x + kAcesE), 0.0f, 1.0f);
}

// ---- filters (2020, sections 4.2 and 4.4); all are sums of products of a horizontal and a vertical one ----

template <class Function>
Kernel makeKernel(int radius, Function function) {
    Kernel kernel(2 * radius + 1);
    for (int i = -radius; i <= radius; ++i) kernel[i + radius] = static_cast<float>(function(i));
    return kernel;
}

/// Positive taps are scaled to the sum 1, negative ones to -1.
void normalize(Kernel& kernel) {
    double positive = 0, negative = 0;
    for (const float tap : kernel) (tap > 0 ? positive : negative) += tap;
    for (float& tap : kernel) tap = static_cast<float>(tap > 0 ? tap / positive : tap < 0 ? -tap / negative : 0);
}

/// One term a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees, of a contrast sensitivity in the plane.
struct SensitivityTerm {
    double a, b;
};
constexpr SensitivityTerm kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053}, kBlueYellow1{34.1, 0.04},
    kBlueYellow2{13.5, 0.025};

struct Filters {
    Kernel achromatic, redGreen, blueYellow1, blueYellow2;
    float blueYellowShare1;  // weight of the first term; that of the second is the rest
    Kernel gauss, edge, point;

    Filters() {
        const double widest = kBlueYellow1.b;
        const int radius = static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * kPi * kPi)) * kFlipPixelsPerDegree));
        double sum1 = 0, sum2 = 0;
        achromatic = sensitivity(kAchromatic, radius);
        redGreen = sensitivity(kRedGreen, radius);
        blueYellow1 = sensitivity(kBlueYellow1, radius, &sum1);
        blueYellow2 = sensitivity(kBlueYellow2, radius, &sum2);
        blueYellowShare1 = static_cast<float>(sum1 / (sum1 + sum2));

        const double sigma = 0.5 * 0.082 * kFlipPixelsPerDegree;  // features are 0.082 degrees wide
        const int featureRadius = static_cast<int>(std::ceil(3 * sigma));
        const auto bell = [sigma](int i) { return std::exp(-i * i / (2 * sigma * sigma)); };
        gauss = makeKernel(featureRadius, bell);
        edge = makeKernel(featureRadius, [&](int i) { return -i * bell(i); });
        point = makeKernel(featureRadius, [&](int i) { return (i * i / (sigma * sigma) - 1) * bell(i); });
        for (Kernel* kernel : {&gauss, &edge, &point}) normalize(*kernel);
    }

    /// The term's normalised one-dimensional factor and its sum over the plane before it was normalised.
    static Kernel sensitivity(const SensitivityTerm& term, int radius, double* sumInPlane = nullptr) {
        Kernel kernel = makeKernel(radius, [&](int i) {
            const double x = i / kFlipPixelsPerDegree;
            return std::exp(-kPi * kPi * x * x / term.b);
        });
        double sum = 0;
        for (const float tap : kernel) sum += tap;
        normalize(kernel);
        if (sumInPlane) *sumInPlane = term.a * std::sqrt(kPi / term.b) * sum * sum;
        return kernel;
    }
};

const Filters& flipFilters() {
    static const Filters filters;
    return filters;
}

/// What the eye sees of one tone-mapped image.
struct Perceived {
    std::vector<Color> lab;
    Plane edges, points;
};

/// Tells what the eye sees of images of one size. Keeps its planes from image to image.
class Eye {
public:
    Eye(int width, int height) : convolver_(width, height) {
        const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        for (Plane* plane : {&luma_, &redGreen_, &blueYellow_, &seenLuma_, &seenRedGreen_, &seen1_, &seen2_, &smooth_})
            plane->resize(count);
    }

    void perceive(const Image& image, float exposureFactor, Perceived& result) {
        const std::size_t count = image.pixels.size();
        for (std::size_t i = 0; i < count; ++i) {
            const auto shown = [&](float v) { return toneMap(std::max(v, 0.0f) * exposureFactor); };
            const Rgb& p = image.pixels[i];
            const Color c = linearToYcxcz({shown(p.x), shown(p.y), shown(p.z)});
            luma_[i] = c.x;
            redGreen_[i] = c.y;
            blueYellow_[i] = c.z;
        }

        const Filters& filters = flipFilters();
        convolver_.both(luma_, filters.achromatic, seenLuma_);
        convolver_.both(redGreen_, filters.redGreen, seenRedGreen_);
        convolver_.both(blueYellow_, filters.blueYellow1, seen1_);
        convolver_.both(blueYellow_, filters.blueYellow2, seen2_);
        const float share = filters.blueYellowShare1;
        result.lab.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            Color rgb = ycxczToLinear({seenLuma_[i], seenRedGreen_[i], share * seen1_[i] + (1 - share) * seen2_[i]});
            for (float* v : {&rgb.x, &rgb.y, &rgb.z}) *v = std::clamp(*v, 0.0f, 1.0f);
            result.lab[i] = linearToHuntLab(rgb);
        }

        for (float& v : luma_) v = (v + 16) / 116;
        convolver_.horizontal(luma_, filters.gauss, smooth_);
        gradient(filters.edge, result.edges);
        gradient(filters.point, result.points);
    }

private:
    /// Length of what the kernel finds across and down in the luma.
    void gradient(const Kernel& kernel, Plane& result) {
        Plane &across = seen1_, &down = seen2_;
        convolver_.horizontal(luma_, kernel, down);
        convolver_.vertical(down, flipFilters().gauss, across);
        convolver_.vertical(smooth_, kernel, down);
        result.resize(luma_.size());
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] = std::sqrt(across[i] * across[i] + down[i] * down[i]);
    }

    Convolver convolver_;
    Plane luma_, redGreen_, blueYellow_, seenLuma_, seenRedGreen_, seen1_, seen2_, smooth_;
};

// ---- the error of a pixel (2020, sections 4.3 to 4.5) ----

constexpr float kColorExponent = 0.7f;
constexpr float kColorKnee = 0.4f, kErrorAtKnee = 0.95f;

/// Colour distance to [0, 1]: the small ones, up to the knee, take most of the range.
float colorError(float distance, float largest) {
    const float d = std::pow(distance, kColorExponent), knee = kColorKnee * largest;
    return d < knee ? kErrorAtKnee / knee * d : kErrorAtKnee + (d - knee) / (largest - knee) * (1 - kErrorAtKnee);
}

}  // namespace

FlipExposures flipExposures(const Image& reference) {
    std::vector<double> y;
    y.reserve(reference.pixels.size());
    for (const Rgb& p : reference.pixels) {
        const auto light = [](float v) { return std::max<double>(v, 0); };
        y.push_back(0.2126 * light(p.x) + 0.7152 * light(p.y) + 0.0722 * light(p.z));  // NVIDIA's rounding
    }
    std::nth_element(y.begin(), y.begin() + y.size() / 2, y.end());
    // A black image has no exposure of its own; NVIDIA's program ends at the epsilon of float too.
    const double floor = std::numeric_limits<float>::epsilon();
    const double median = std::max(y[y.size() / 2], floor);
    const double brightest = std::max(*std::max_element(y.begin(), y.end()), floor);

    // The scene value that the tone mapping takes to 0.85 of the screen.
    constexpr double kShown = 0.85;
    const double a = kAcesA - kShown * kAcesC, b = kAcesB - kShown * kAcesD, c = -kShown * kAcesE;
    const double value = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
    const double start = std::log2(value / brightest), stop = std::log2(value / median);
    return {start, stop, std::max(2, static_cast<int>(std::ceil(stop - start)))};
}

std::vector<std::vector<double>> flipErrorMaps(std::span<const Image* const> images, const Image& reference) {
    static const float largest = std::pow(hyab(linearToHuntLab({0, 1, 0}), linearToHuntLab({0, 0, 1})), kColorExponent);

    const FlipExposures exposures = flipExposures(reference);
    const double step = (exposures.stop - exposures.start) / (exposures.count - 1);
    Eye eye(reference.width, reference.height);
    Perceived expected, seen;
    std::vector<std::vector<double>> maps(images.size(), std::vector<double>(reference.pixels.size(), 0.0));
    for (int exposure = 0; exposure < exposures.count; ++exposure) {
        const auto factor = static_cast<float>(std::exp2(exposures.start + exposure * step));
        eye.perceive(reference, factor, expected);
        for (std::size_t n = 0; n < images.size(); ++n) {
            eye.perceive(*images[n], factor, seen);
            std::vector<double>& map = maps[n];
            for (std::size_t i = 0; i < map.size(); ++i) {
                const float color = colorError(hyab(seen.lab[i], expected.lab[i]), largest);
                const float edges = std::abs(seen.edges[i] - expected.edges[i]);
                const float points = std::abs(seen.points[i] - expected.points[i]);
                const float features = std::sqrt(std::max(edges, points) / std::sqrt(2.0f));
                map[i] = std::max<double>(map[i], std::pow(color, 1 - features));
            }
        }
    }
    return maps;
}

}  // namespace ulam
