#include "experiments/statistics/decomposition.h"

#include <cstddef>

#include "core/base/error.h"

namespace ulam::statistics {
namespace {

void requireSize(const char* what, std::size_t expected, std::size_t found) {
    if (expected == found) return;
    fail(ExitCode::InvalidConfig, "decomposition: expected {} values in {}, found {}", expected, what, found);
}

}  // namespace

Decomposition decompose(std::span<const std::span<const float>> images, std::span<const float> reference,
                        std::span<const float> referenceVariance) {
    if (images.size() < 2) {
        fail(ExitCode::InvalidConfig, "decomposition: expected at least two replicates, found {}", images.size());
    }
    for (std::span<const float> image : images) requireSize("a replicate's image", reference.size(), image.size());
    if (!referenceVariance.empty()) requireSize("the variance", reference.size(), referenceVariance.size());

    const auto replicates = static_cast<double>(images.size());
    Decomposition sum;
    for (std::size_t i = 0; i < reference.size(); ++i) {
        // Differences to the reference first: they are small where radiances are large.
        double meanDifference = 0;
        for (std::span<const float> image : images) meanDifference += static_cast<double>(image[i]) - reference[i];
        meanDifference /= replicates;
        double squares = 0;
        for (std::span<const float> image : images) {
            const double d = static_cast<double>(image[i]) - reference[i] - meanDifference;
            squares += d * d;
        }
        const double variance = squares / (replicates - 1);
        const double varianceOfReference = referenceVariance.empty() ? 0.0 : referenceVariance[i];
        sum.variance += variance;
        sum.biasSquared += meanDifference * meanDifference - variance / replicates - varianceOfReference;
    }
    const auto count = static_cast<double>(reference.size());
    return {sum.variance / count, sum.biasSquared / count};
}

}  // namespace ulam::statistics
