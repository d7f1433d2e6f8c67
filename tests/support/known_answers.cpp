#include "tests/support/known_answers.h"

#include <boost/math/distributions/students_t.hpp>
#include <numeric>

namespace ulam {

std::vector<std::string> samplerNames() {
    return Registry<Sampler>::instance().names();
}

bool isChainSampler(const std::string& name) {
    return Registry<Sampler>::instance().create(JsonNode(Json{{"type", name}}))->isChainSampler();
}

std::vector<RenderResult> renderRuns(const Scene& scene, const Json& sampler, const Budget& budget, int runs,
                                     uint64_t seed) {
    const auto made = Registry<Sampler>::instance().create(JsonNode(sampler));
    std::vector<RenderResult> results;
    for (int i = 0; i < runs; ++i) {
        RenderOptions options;
        options.budget = budget;
        options.key = makeKey(seed, 0, uint64_t(i));
        results.push_back(render(scene, *made, options));
    }
    return results;
}

Deviation deviation(const std::vector<double>& values, double truth) {
    const auto n = double(values.size());
    Deviation d;
    d.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double sum = 0;
    for (const double v : values) sum += (v - d.mean) * (v - d.mean);
    d.standardError = std::sqrt(sum / (n * (n - 1)));
    // Rays start a few millionths of the scene's size off their surfaces: no claim is made beyond that.
    const double off = std::max(0.0, std::abs(d.mean - truth) - 1e-5 * std::abs(truth));
    if (off == 0) return d;
    if (d.standardError == 0) return d.p = 0, d;
    d.p = 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(n - 1), off / d.standardError));
    return d;
}

std::vector<double> tileMeans(const Image& image, int tiles) {
    std::vector<double> sums(size_t(tiles * tiles), 0), counts(sums.size(), 0);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const auto tile = size_t(y * tiles / image.height * tiles + x * tiles / image.width);
            const Rgb& p = image.at(x, y);
            sums[tile] += luminance(Spectrum(p.x, p.y, p.z));
            ++counts[tile];
        }
    for (size_t i = 0; i < sums.size(); ++i) sums[i] /= counts[i];
    return sums;
}

void Verdict::add(const Deviation& d, double truth, const std::string& what) {
    ++count_;
    if (d.p >= smallest_ && !worst_.empty()) return;
    smallest_ = d.p;
    worst_ = fmt::format("{}: {:.6g} ± {:.2g}, known {:.6g}, p = {:.3g}", what, d.mean, d.standardError, truth, d.p);
}

void Verdict::check() const {
    REQUIRE(count_ > 0);
    INFO(count_ << " comparisons, the worst: " << worst_);
    CHECK(smallest_ > -std::expm1(std::log1p(-1e-6) / count_));
}

}  // namespace ulam
