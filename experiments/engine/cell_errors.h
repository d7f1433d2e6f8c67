#pragma once
// What comparisons are made of: the primary errors of a cell's finished replicates.

#include "experiments/engine/reference.h"
#include "experiments/statistics/comparison.h"

namespace ulam {

struct CellErrors {
    std::vector<int> replicates;   ///< numbers of the finished ones, rising
    std::vector<double> errors;    ///< primary metric of each
    double referenceVariance = 0;  ///< what debiasing subtracted from each error
    double referenceShare = 0;     ///< see shareOfReference
    bool halvesAgree = true;       ///< of the reference
};

/// Reads the images of the replicates that are finished.
CellErrors cellErrors(const Plan& plan, const Cell& cell, const Reference& reference,
                      const std::filesystem::path& runDir);
/// What debiasing subtracts from the primary metric of any image.
double referenceVariance(const Plan& plan, const Reference& reference);
/// The error of an image by which its reference is judged: the primary metric, or relMSE where that one is not debiased and
/// would not show the noise of the reference.
double judgingError(const Plan& plan, const Reference& reference, const Image& image);
/// The variance of the reference over a mean judging error; infinite where that is not positive.
double shareOfReference(const Plan& plan, const Reference& reference, double meanJudgingError);
/// Whether such a share leaves errors that cannot be judged.
bool isTooPoor(double referenceShare);

/// Indices into the errors of two cells: all, or the pairs of replicates that both have where random numbers are common.
struct ComparedReplicates {
    std::vector<std::size_t> sampler, baseline;

    bool empty() const { return sampler.empty() || baseline.empty(); }
};
ComparedReplicates comparedReplicates(const statistics::Design& design, const CellErrors& sampler,
                                      const CellErrors& baseline);

/// All comparisons of a plan, decided; in its order, without those where a cell has no replicate that can be compared.
struct DecidedComparison {
    PlannedComparison planned;
    ComparedReplicates replicates;
    statistics::Comparison result;
};
std::vector<DecidedComparison> decideComparisons(const Plan& plan, const std::vector<const CellErrors*>& cells);

template <class T>
std::vector<T> pick(const std::vector<T>& values, const std::vector<std::size_t>& indices) {
    std::vector<T> picked;
    picked.reserve(indices.size());
    for (const std::size_t i : indices) picked.push_back(values[i]);
    return picked;
}

}  // namespace ulam
