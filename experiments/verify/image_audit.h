#pragma once
// Audit level L5: images. Independent runs of a sampler against bidirectional path tracing: Welch's t for every tile
// and channel, corrected by Holm, and the interval of the total energy.

#include "core/mcmc/audit/scenes.h"
#include "core/render/driver.h"
#include "experiments/statistics/welch.h"

namespace ulam::verify {

/// Level of the tile tests of one subject, and confidence of the energy interval.
inline constexpr double kTileLevel = 1e-5, kEnergyConfidence = 0.99999;

/// Means over independent runs.
struct TiledEstimate {
    std::vector<statistics::MeanEstimate> tiles;  ///< tile by tile, three channels each
    size_t across = 0;                            ///< tiles in a row
    statistics::MeanEstimate energy;              ///< mean luminance
    std::vector<std::string> biasLedger;          ///< of the runs
};

/// Images of independent runs, of whatever renderer; their sides are multiples of 8 pixels.
class TiledRuns {
public:
    void add(const Image& image);
    TiledEstimate estimate() const;

private:
    std::vector<std::vector<double>> tiles_;
    std::vector<double> energy_;
    size_t across_ = 0;
};

/// Independent runs of a sampler, each with the budget; `seed` and `cell` choose their random numbers.
TiledEstimate renderTiled(const Scene& scene, const Json& sampler, const Budget& budget, int runs, uint64_t seed,
                          uint64_t cell, int threads);

struct ImageComparison {
    std::string place;       ///< for messages
    std::vector<double> p;   ///< of every tile and channel, not adjusted
    size_t tilesAcross = 0;
    double energyShift = 0;  ///< relative to the reference
    double energyWidth = 0;  ///< half of the interval's width, relative to the reference
    bool energyHolds() const { return std::abs(energyShift) <= energyWidth; }
};
/// Share of the tiles that the reference has light in where the image has some too.
double coverage(const Image& image, const TiledEstimate& reference);

ImageComparison compare(std::string place, const TiledEstimate& runs, const TiledEstimate& reference);

}  // namespace ulam::verify
