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

void addTiles(std::vector<MeanEstimate>& half, const std::vector<double>& tiles) {
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        if (half.size() == t)
            half.push_back(single(tiles[t]));
        else
            half[t] = statistics::combined(half[t], single(tiles[t]));
    }
}

/// One channel of one pixel over all parts.
MeanEstimate pixel(const std::vector<Image>& parts, const CombinedParts& before, std::size_t i, int channel) {
    double sum = 0, squares = 0;
    const auto n = static_cast<double>(parts.size());
    for (const Image& part : parts) sum += part.pixels[i][channel];
    for (const Image& part : parts) {
        const double d = part.pixels[i][channel] - sum / n;
        squares += d * d;
    }
    const MeanEstimate own{sum / n, n > 1 ? squares / ((n - 1) * n) : 0, n - 1};
    if (before.parts == 0) return own;
    return statistics::combined({before.image.pixels[i][channel], before.variance.pixels[i][channel], before.parts - 1.0}, own);
}

}  // namespace

double CombinedParts::smallestP() const {
    std::vector<double> p;
    for (std::size_t t = 0; t < halves[0].size(); ++t) p.push_back(statistics::welchTest(halves[0][t], halves[1][t]).p);
    return std::ranges::min(statistics::holmAdjusted(p));
}

CombinedParts combineParts(const std::vector<Image>& parts, const CombinedParts& before) {
    CombinedParts combined = before;
    for (const Image& part : parts) addTiles(combined.halves[static_cast<std::size_t>(combined.parts++ % 2)], tileMeans(part));
    const Image& first = parts.front();
    combined.image = combined.variance = Image(first.width, first.height);
    for (std::size_t i = 0; i < first.pixels.size(); ++i) {
        for (int channel = 0; channel < 3; ++channel) {
            const MeanEstimate all = pixel(parts, before, i, channel);
            combined.image.pixels[i][channel] = static_cast<float>(all.mean);
            combined.variance.pixels[i][channel] = static_cast<float>(all.varianceOfMean);
        }
    }
    return combined;
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
