#include "experiments/engine/reference_parts.h"

#include <algorithm>

#include "experiments/statistics/holm.h"

namespace ulam {
namespace {

using statistics::MeanEstimate;

/// Mean luminance of every tile.
std::vector<double> tileMeans(const Image& image) {
    const int columns = (image.width + kTileSize - 1) / kTileSize, rows = (image.height + kTileSize - 1) / kTileSize;
    std::vector<double> sums(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)), counts(sums.size());
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto tile = static_cast<std::size_t>(y / kTileSize * columns + x / kTileSize);
            sums[tile] += luminance(Spectrum(image.at(x, y)));
            counts[tile] += 1;
        }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= counts[i];
    return sums;
}

MeanEstimate single(double value) {
    return {value, 0, 0};
}

}  // namespace

double CombinedParts::smallestP() const {
    std::vector<double> p;
    for (std::size_t t = 0; t < halves[0].size(); ++t) p.push_back(statistics::welchTest(halves[0][t], halves[1][t]).p);
    return std::ranges::min(statistics::holmAdjusted(p));
}

void addValues(std::vector<MeanEstimate>& estimates, const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (estimates.size() == i)
            estimates.push_back(single(values[i]));
        else
            estimates[i] = statistics::combined(estimates[i], single(values[i]));
    }
}

void CombinedParts::add(const Image& part) {
    addValues(halves[static_cast<std::size_t>(parts % 2)], tileMeans(part));
    if (parts == 0) image = part, variance = Image(part.width, part.height);
    // Rounded to what files hold after every part, not after the last one: so it does not matter which parts were
    // combined first and read again. That is about 1e-7 of a value a part, far below the noise.
    for (std::size_t i = 0; parts > 0 && i < part.pixels.size(); ++i) {
        for (int channel = 0; channel < 3; ++channel) {
            float &mean = image.pixels[i][channel], &ofMean = variance.pixels[i][channel];
            const MeanEstimate all = statistics::combined({mean, ofMean, parts - 1.0}, single(part.pixels[i][channel]));
            mean = static_cast<float>(all.mean);
            ofMean = static_cast<float>(all.varianceOfMean);
        }
    }
    ++parts;
}

Json halvesJson(const CombinedParts& combined) {
    Json json = Json::array();
    for (const auto& half : combined.halves) {
        Json means = Json::array(), variances = Json::array();
        for (const MeanEstimate& tile : half) means.push_back(tile.mean), variances.push_back(tile.varianceOfMean);
        json.push_back({{"degrees", half.front().degrees}, {"mean", std::move(means)}, {"variance_of_mean", std::move(variances)}});
    }
    return json;
}

std::array<std::vector<MeanEstimate>, 2> halvesFromJson(const JsonNode& json) {
    const std::vector<JsonNode> both = json.elements();
    std::array<std::vector<MeanEstimate>, 2> halves;
    if (both.size() != halves.size()) json.expected("two halves");
    for (std::size_t h = 0; h < halves.size(); ++h) {
        const double degrees = both[h].at("degrees").number();
        const std::vector<JsonNode> means = both[h].at("mean").elements(), variances = both[h].at("variance_of_mean").elements();
        if (means.size() != variances.size()) both[h].expected("a variance of each mean");
        for (std::size_t t = 0; t < means.size(); ++t) halves[h].push_back({means[t].number(), variances[t].number(), degrees});
    }
    return halves;
}

}  // namespace ulam
