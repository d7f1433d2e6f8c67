#include "experiments/verify/image_audit.h"

#include "experiments/statistics/moments.h"

namespace ulam::verify {
namespace {

constexpr int kTile = 8;  // pixels; the audit scenes' films are small

std::vector<double> tileMeans(const Image& image) {
    std::vector<double> means;
    for (int y0 = 0; y0 < image.height; y0 += kTile)
        for (int x0 = 0; x0 < image.width; x0 += kTile) {
            Spectrum sum(0.0);
            for (int y = y0; y < y0 + kTile; ++y)
                for (int x = x0; x < x0 + kTile; ++x) sum += Spectrum(image.at(x, y));
            sum /= kTile * kTile;
            means.insert(means.end(), {sum.x, sum.y, sum.z});
        }
    return means;
}

}  // namespace

void TiledRuns::add(const Image& image) {
    const std::vector<double> means = tileMeans(image);
    tiles_.resize(means.size());
    double sum = 0;
    for (size_t i = 0; i < means.size(); ++i) tiles_[i].push_back(means[i]);
    for (size_t i = 0; i < means.size(); i += 3) sum += luminance(Spectrum(means[i], means[i + 1], means[i + 2]));
    across_ = size_t(image.width / kTile);
    energy_.push_back(3 * sum / double(means.size()));
}

TiledEstimate TiledRuns::estimate() const {
    TiledEstimate estimate;
    estimate.across = across_;
    for (const auto& values : tiles_) estimate.tiles.push_back(statistics::estimateMean(values));
    estimate.energy = statistics::estimateMean(energy_);
    return estimate;
}

TiledEstimate renderTiled(const Scene& scene, const Json& sampler, const Budget& budget, int runs, uint64_t seed,
                          uint64_t cell, int threads) {
    TiledRuns tiled;
    std::vector<std::string> biasLedger;
    const auto made = Registry<Sampler>::instance().create(JsonNode(sampler));
    for (int r = 0; r < runs; ++r) {
        RenderOptions options;
        options.budget = budget;
        options.key = makeKey(seed, cell, uint64_t(r));
        options.threads = threads;
        const RenderResult result = render(scene, *made, options);
        tiled.add(result.image);
        biasLedger = result.statistics.biasLedger;
    }
    TiledEstimate estimate = tiled.estimate();
    estimate.biasLedger = std::move(biasLedger);
    return estimate;
}

double coverage(const Image& image, const TiledEstimate& reference) {
    const std::vector<double> means = tileMeans(image);
    size_t lit = 0, covered = 0;
    for (size_t i = 0; i < means.size(); ++i)
        if (reference.tiles[i].mean > 0) ++lit, covered += means[i] > 0;
    return lit ? double(covered) / double(lit) : 1;
}

ImageComparison compare(std::string place, const TiledEstimate& runs, const TiledEstimate& reference) {
    ImageComparison c;
    c.place = std::move(place);
    c.tilesAcross = runs.across;
    c.p = statistics::welchPValues(runs.tiles, reference.tiles);
    const auto &a = runs.energy, &b = reference.energy;
    const double degrees = statistics::welchDegrees(a.varianceOfMean, a.degrees, b.varianceOfMean, b.degrees);
    c.energyShift = a.mean / b.mean - 1;
    c.energyWidth = statistics::studentQuantile(degrees, 1 - (1 - kEnergyConfidence) / 2) *
                    std::sqrt(a.varianceOfMean + b.varianceOfMean) / b.mean;
    return c;
}

}  // namespace ulam::verify
