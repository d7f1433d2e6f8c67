#pragma once
// Histograms of what was observed against what a density says, the expectation being an importance-sampled estimate
// whose own error is part of the test.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ulam::audit {

/// One coordinate of proposals: relative frequencies and expected ones by bin. The first and last bin are open.
struct Marginal {
    std::string name;
    std::vector<double> edges;                      ///< bins + 1 values
    std::vector<double> observed, expected, error;  ///< error: standard error of `expected`
    double statistic = 0, degrees = 0, p = 1;
};

/// Coordinates of proposals; what lies far out or does not vary is left to whoever names them.
using Coordinates = std::vector<double>;

/// Collects both sides of the comparison. Bins hold equal shares of a pilot sample, which is used for nothing else.
class MarginalTest {
public:
    /// Coordinates that do not vary in the pilot are left out.
    MarginalTest(const std::vector<std::string>& names, const std::vector<Coordinates>& pilot);

    void observe(const Coordinates& c);
    /// `weight`: density over the density that made the sample.
    void expect(const Coordinates& c, double weight);

    /// Of `proposals` and `references` tries, counting those that came to nothing. The first marginal is the mass: all
    /// in one bin.
    std::vector<Marginal> finish(uint64_t proposals, uint64_t references) const;

private:
    struct Bins {
        size_t coordinate;
        std::string name;
        std::vector<double> edges;
        std::vector<double> observed, sum, squares;  ///< counts, Σ weight, Σ weight²
        size_t find(double value) const;
    };
    std::vector<Bins> bins_;
    Bins all_;
};

/// A length from a pilot sample of lengths: uniform within bins that hold equal shares of them, and now and then a little
/// beyond the pilot's extremes.
class PilotLength {
public:
    PilotLength() = default;
    /// No length is above `longest`.
    PilotLength(std::vector<double> pilot, double longest);
    bool empty() const { return edges_.empty(); }
    /// The pilot's shortest, but for one bin of them.
    double shortest() const { return empty() ? 0 : edges_[2]; }
    double sample(double u) const;
    double pdf(double length) const;

private:
    std::vector<double> edges_;
};

}  // namespace ulam::audit
