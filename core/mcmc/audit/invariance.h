#pragma once
// Audit level L4, invariance: what is true of a kernel that leaves π invariant, tested on scenes.
//
// X_0 is a state of a bootstrap sample of weight w, so that E[w φ(X_0)] = ∫ π φ for every φ. Samples are taken with
// probability min(1, w/c) and then weigh max(w, c)/c: rejection control (Liu, Chen & Wong 1998), which keeps that
// expectation exact and the weights near 1. For test functions g and h these have expectation zero:
//   w (h(X_n) − h(X_0))                           the start-up identity
//   w Σ_i (g(X_i) h(X_i+1) − h(X_i) g(X_i+1))     for reversible kernels
// Starts are independent, so each sum over its standard error is normal in the limit.

#include "core/mcmc/audit/subject.h"

namespace ulam::audit {

/// What test functions are taken from; scale and centre of each come from a pilot run, so that all are bounded.
class TestFunctions {
public:
    TestFunctions(const AuditScene& scene, const Subject& subject, RandomKey key);

    size_t size() const { return center_.size(); }
    /// All values in (−1, 1).
    std::vector<double> operator()(const Sample& x) const;
    std::string name(size_t i) const;
    /// The constant c of the rejection control.
    double weightLimit() const { return weightLimit_; }

private:
    Space space_;
    std::vector<double> center_, scale_;
    double weightLimit_ = 0;
};

inline constexpr int kStepsPerStart = 16;

struct InvarianceTally {
    uint64_t starts = 0, steps = 0, accepted = 0;
    std::vector<double> sum, squares;  ///< of every identity
    void merge(const InvarianceTally& later);
};

/// Bootstrap samples [begin, end).
InvarianceTally auditInvariance(const AuditScene& scene, const Subject& subject, const TestFunctions& functions,
                                RandomKey key, uint64_t begin, uint64_t end);

struct IdentityTest {
    std::string name;
    double z = 0, p = 1;  ///< two-sided
};
/// One test for each identity.
std::vector<IdentityTest> identityTests(const TestFunctions& functions, const InvarianceTally& tally);

}  // namespace ulam::audit
