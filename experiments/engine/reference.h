#pragma once
// References: what images are compared with. A sampler makes one in independent parts of one size, half of them in each
// of two halves that must agree; the parts also give the variance of their mean, pixel by pixel. The key of a reference
// says what a part is: scene, film, depth, sampler, its budget and the program; how many there are is the reference's
// quality. Asked for more, it is extended by those that are new, and is then the same as if all had been made at once.

#include "experiments/engine/plan.h"
#include "experiments/engine/reference_parts.h"

namespace ulam {

/// Level at which halves disagree, over all tiles of the image (Holm).
inline constexpr double kHalvesLevel = 1e-3;
struct Reference {
    Image image, variance;  ///< variance of the mean image; zero where the image is exact
    bool halvesAgree = true;
    int parts = 0;  ///< that a sampler made of it
    /// Share of each of the scene's features in the image's energy; empty where not known.
    std::vector<statistics::MeanEstimate> featureShares;
    /// Known biases of the sampler that made it, in words; not those of the scene, which judged images have, too.
    std::vector<std::string> biasLedger;
};

/// RUN_DIR/references/KEY
std::filesystem::path referenceFolder(const PlannedReference& reference, const std::filesystem::path& runDir);
/// That folder holds the reference, undamaged and with as many parts as are asked for.
bool isReady(const PlannedReference& reference, const std::filesystem::path& runDir);
/// RUN_DIR/references/KEY holds the reference: from this run, from the cache across runs, from a file, or exact. False
/// where a sampler still has to make parts. What is damaged, in the run or in the cache, is removed. This and finishReference
/// are for one process at a time.
bool prepareReference(const PlannedReference& reference, const std::filesystem::path& runDir);
/// Parts that a sampler has made and that are combined: the first ones, which are not asked for again.
int readyParts(const PlannedReference& reference, const std::filesystem::path& runDir);
/// Where the other parts of a reference stand until it is complete.
std::filesystem::path partsFolder(const PlannedReference& reference, const std::filesystem::path& runDir);
/// Combines the finished parts, with those before, writes image.exr, variance.exr and result.json, fills the cache, removes the parts.
/// Fails with InvalidConfig where the image is black.
void finishReference(const PlannedReference& reference, const std::filesystem::path& runDir);
/// Of a prepared or finished reference.
Reference readReference(const PlannedReference& reference, const std::filesystem::path& runDir);

/// Parts that the cache holds of it, undamaged.
int cachedParts(const PlannedReference& reference);

/// Of references whose sampler is of a type that they judge.
std::vector<std::string> sharedBiasWarnings(const Plan& plan);

/// $XDG_CACHE_HOME/ulam/references, or ~/.cache/ulam/references.
std::filesystem::path referenceCache();

}  // namespace ulam
