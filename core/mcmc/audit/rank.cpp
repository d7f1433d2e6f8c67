#include "core/mcmc/audit/rank.h"

#include <boost/math/special_functions/gamma.hpp>

namespace ulam::audit {
namespace {

class ToyTarget : public Target {
public:
    explicit ToyTarget(const Scene& scene) : tracing_(scene) {}

    static constexpr double kBound = 4.1;
    static double density(double a, double b) {
        if (a < 0.2) return 0;
        const double ridge = (b - 0.5 - 0.3 * std::sin(2 * kPi * a)) / 0.05;
        const double peak = ((a - 0.7) * (a - 0.7) + (b - 0.3) * (b - 0.3)) / (0.03 * 0.03);
        return 0.05 + std::exp(-ridge * ridge / 2) + 3 * std::exp(-peak / 2);
    }

    Space space() const override { return Space::Primary; }
    Tracing& tracing() override { return tracing_; }
    Reject evaluateNumbers(Sample& y, Random& random) override {
        Numbers numbers(y.u, random);
        const Block& u = numbers(NumberStream::Camera, 0);
        const double pi = density(u[0], u[1]);
        if (!(pi > 0)) return Reject::ZeroTarget;
        y.logTarget = std::log(pi);
        y.splats.clear();
        y.splats.add({Vec2f(float(u[0]), float(u[1])), Spectrum(1.0)});
        return Reject::None;
    }
    Reject evaluatePath(Sample&) override { return Reject::ZeroTarget; }
    double redrawTechnique(Sample&, Random&, bool) override { return 0; }
    double logTechnique(Sample&) override { return 0; }
    double bootstrapWeight(Random&) override { return 1; }
    /// An exact draw.
    bool seed(Random& random, double, Sample& x) override {
        bool accepted = false;
        do {
            const Block u = random.nextBlock();
            x.u.clear();
            x.u.append(NumberStream::Camera, u);
            accepted = u[2] * kBound < density(u[0], u[1]);
            // Numbers that the target does not use must not know of the rejection.
            x.u(NumberStream::Camera, 0)[2] = random();
        } while (!accepted);
        return evaluateNumbers(x, random) == Reject::None;
    }

private:
    Tracing tracing_;
};

class Ignore : public StepObserver {
public:
    void observe(const Chain&, const Proposal&, const StepInfo&) override {}
};

std::array<double, 3> values(const Sample& x) {
    const Block& u = x.u(NumberStream::Camera, 0);
    return {u[0], u[1], x.logTarget};
}

}  // namespace

void RankTally::merge(const RankTally& later) {
    chains += later.chains;
    for (size_t h = 0; h < counts.size(); ++h)
        for (size_t r = 0; r < counts[h].size(); ++r) counts[h][r] += later.counts[h][r];
}

RankTally auditRanks(const AuditScene& scene, const Subject& subject, RandomKey key, uint64_t begin, uint64_t end) {
    ToyTarget target(scene.scene);
    Kernel kernel(subject.mix());
    Ignore observer;
    RankTally tally;
    for (uint64_t i = begin; i < end; ++i) {
        Random random = randomOf(key, Stream::Rank, i);
        Chain start;
        target.seed(random, 0, start.x);
        kernel.enter(start);
        const int position = random.index(kRanks);
        const auto own = values(start.x);
        std::array<int, 3> below{}, equal{};
        StepContext context{random, target.tracing(), scene.limits};
        for (const int steps : {position, kRanks - 1 - position}) {
            Chain chain = start;
            for (int s = 0; s < steps; ++s) {
                kernel.step(chain, target, context, observer);
                const auto other = values(chain.x);
                for (size_t h = 0; h < own.size(); ++h) below[h] += other[h] < own[h], equal[h] += other[h] == own[h];
            }
        }
        for (size_t h = 0; h < own.size(); ++h) ++tally.counts[h][size_t(below[h] + random.index(equal[h] + 1))];
        ++tally.chains;
    }
    return tally;
}

double rankTest(const RankTally& tally) {
    double smallest = 1;
    for (const auto& counts : tally.counts) {
        const double expected = double(tally.chains) / kRanks;
        double statistic = 0;
        for (uint64_t n : counts) statistic += (double(n) - expected) * (double(n) - expected) / expected;
        smallest = std::min(smallest, boost::math::gamma_q((kRanks - 1) / 2.0, statistic / 2));
    }
    return std::min(1.0, smallest * double(tally.counts.size()));
}

}  // namespace ulam::audit
