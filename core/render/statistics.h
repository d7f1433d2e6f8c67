#pragma once
// What a run reports beside its image: the numbers of result.json.

#include "core/config/json.h"
#include "core/image/image.h"
#include "core/mcmc/statistics.h"
#include "core/mcmc/trace.h"
#include "core/render/non_finite_log.h"

#include <map>
#include <string>
#include <vector>

namespace ulam {

struct RenderStatistics {
    uint64_t rays = 0;
    uint64_t samples = 0;    ///< independent samples, those of the bootstrap included
    uint64_t mutations = 0;
    uint64_t chains = 0;
    uint64_t unsampledPixels = 0;  ///< that have none of their own samples, and are black instead
    double seedingSeconds = 0;
    uint64_t seedingRays = 0;
    double normalization = 0;               ///< b; 0 for samplers without chains
    double normalizationStandardError = 0;
    std::map<std::string, MutationStatistics> mutationStatistics;
    NonFiniteLog nonFinite;                     ///< samples and steps with values that were refused
    std::vector<std::string> biasLedger;        ///< every known source of bias of this run, in words
    /// Of each of the scene's features: the energy (luminance) that passed it, and how often a chain came to it from
    /// another one.
    std::vector<double> featureEnergy;
    std::vector<uint64_t> featureJumps;
    Json diagnostics = Json::object();          ///< further numbers of the sampler
    std::vector<ChainTrace> traces;             ///< of the chains
    std::map<std::string, Image> extraImages;   ///< e.g. per-technique images, by name
};

struct Snapshot {
    double fraction;  ///< of the budget
    double seconds;
    uint64_t rays, samples, mutations;
    Image image;

    template <class Archive>
    void archive(Archive& a) {
        a(fraction, seconds, rays, samples, mutations, image);
    }
};

}  // namespace ulam
