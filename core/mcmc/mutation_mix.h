#pragma once
// The mutations of a chain and their weights, as an experiment states them.

#include "core/mcmc/sample.h"

#include <memory>
#include <string>
#include <vector>

namespace ulam {

class MutationMix {
public:
    struct Entry {
        std::string name;  ///< as in the config
        double weight;
        std::unique_ptr<Mutation> mutation;
    };

    /// From {"name": {"weight": 0.5, parameters…}, …}: a name is a mutation, or free with a "type". Only mutations that
    /// can work on the target are accepted: Path mutations need a Path target.
    static MutationMix fromConfig(const JsonNode& config, Space target);
    /// The same with every parameter written out.
    static Json resolve(const JsonNode& config);

    MutationMix() = default;
    explicit MutationMix(std::vector<Entry> entries) : entries_(std::move(entries)) {}

    size_t size() const { return entries_.size(); }
    const Entry& operator[](size_t i) const { return entries_[i]; }

    /// Z(x) = Σ_j weight_j · suit_j(x), with the terms left in `terms`.
    double suitabilities(const Sample& x, std::vector<double>& terms) const;

    /// Probability of the mutations that do not depend on the current state, where all are suitable.
    double largeStepProbability() const;

private:
    std::vector<Entry> entries_;
};

}  // namespace ulam
