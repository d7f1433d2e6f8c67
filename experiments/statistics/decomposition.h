#pragma once
// Variance and squared bias of an image, from replicates.

#include <span>

namespace ulam::statistics {

struct Decomposition {
    double variance = 0;                                     // of one replicate
    double biasSquared = 0;                                  // unbiased, therefore possibly negative
    double error() const { return variance + biasSquared; }  // the debiased MSE, averaged over the replicates
};

/// Averages over all values (pixels × channels) of
///     Var(p)   = Σ (x_r − x̄)² / (R − 1)
///     bias²(p) = (x̄ − ref)² − Var / R − Var_ref.
/// Images are equally long interleaved RGB arrays, at least two of them. `referenceVariance` is that of the mean
/// reference image, per value, or empty for an exact reference. Throws where the sizes differ.
Decomposition decompose(std::span<const std::span<const float>> images, std::span<const float> reference,
                        std::span<const float> referenceVariance);

}  // namespace ulam::statistics
