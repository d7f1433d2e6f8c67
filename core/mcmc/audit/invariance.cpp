#include "core/mcmc/audit/invariance.h"

namespace ulam::audit {
namespace {

constexpr uint64_t kPilotSamples = 4000;
// In units of the mean weight: about half of the bootstrap's light is kept, and few weights stand out.
constexpr double kWeightLimit = 2;

constexpr std::array kPathFunctions{"raster x", "raster y",          "redness",   "log f",     "length",
                                    "emitter",  "specular vertices", "light end", "camera end"};
constexpr std::array kPrimaryFunctions{"raster x", "raster y",       "redness",        "log f",
                                       "splats",   "light number 1", "light number 2", "camera number 1"};

std::vector<double> rawValues(const Sample& x, Space space) {
    const Splat& splat = x.splats[0];
    std::vector<double> h{splat.raster.x, splat.raster.y, splat.value.x, x.logTarget};
    if (space == Space::Primary) {
        h.push_back(x.splats.size());
        const Block &light = x.u(NumberStream::Light, 0), &camera = x.u(NumberStream::Camera, 0);
        h.insert(h.end(), {light[1], light[2], camera[0]});
        return h;
    }
    const Path& path = x.path;
    int specular = 0;
    for (int i = 0; i < path.size(); ++i) specular += isDelta(path[i].lobe);
    h.insert(h.end(), {double(path.length()), double(path.light().kind), double(specular), path.light().position.x,
                       path[path.length() - 1].position.z});
    return h;
}

class StepCounter : public StepObserver {
public:
    void observe(const Chain&, const Proposal&, const StepInfo& info) override { accepted += info.accepted; }
    uint64_t accepted = 0;
};

}  // namespace

TestFunctions::TestFunctions(const AuditScene& scene, const Subject& subject, RandomKey key)
    : space_(subject.target()) {
    const auto target = subject.makeTarget(scene);
    std::vector<double> sum, squares;
    double weights = 0, total = 0;
    Sample x;
    for (uint64_t i = 0; i < kPilotSamples; ++i) {
        Random random = randomOf(key, Stream::Normal, i), again = random;
        const double w = target->bootstrapWeight(random);
        total += w;
        if (!(w > 0) || !target->seed(again, randomOf(key, Stream::Choice, i)(), x)) continue;
        const std::vector<double> h = rawValues(x, space_);
        sum.resize(h.size()), squares.resize(h.size());
        for (size_t j = 0; j < h.size(); ++j) sum[j] += w * h[j], squares[j] += w * h[j] * h[j];
        weights += w;
    }
    weightLimit_ = kWeightLimit * total / double(kPilotSamples);
    for (size_t j = 0; j < sum.size(); ++j) {
        center_.push_back(sum[j] / weights);
        const double variance = squares[j] / weights - center_[j] * center_[j];
        scale_.push_back(variance > 1e-12 ? std::sqrt(variance) : 1);
    }
}

std::vector<double> TestFunctions::operator()(const Sample& x) const {
    std::vector<double> h = rawValues(x, space_);
    for (size_t j = 0; j < h.size(); ++j) {
        const double d = (h[j] - center_[j]) / scale_[j];
        h[j] = d / std::sqrt(1 + d * d);
    }
    return h;
}

std::string TestFunctions::name(size_t i) const {
    return space_ == Space::Path ? kPathFunctions[i] : kPrimaryFunctions[i];
}

void InvarianceTally::merge(const InvarianceTally& later) {
    starts += later.starts, steps += later.steps, accepted += later.accepted;
    sum.resize(std::max(sum.size(), later.sum.size())), squares.resize(sum.size());
    for (size_t i = 0; i < later.sum.size(); ++i) sum[i] += later.sum[i], squares[i] += later.squares[i];
}

InvarianceTally auditInvariance(const AuditScene& scene, const Subject& subject, const TestFunctions& functions,
                                RandomKey key, uint64_t begin, uint64_t end) {
    const auto target = subject.makeTarget(scene);
    Kernel kernel(subject.mix());
    StepCounter counter;
    const size_t n = functions.size();
    InvarianceTally tally;
    tally.sum.resize(n + n * (n - 1) / 2), tally.squares.resize(tally.sum.size());
    Chain chain;
    for (uint64_t i = begin; i < end; ++i) {
        Random bootstrap = randomOf(key, Stream::Start, i), again = bootstrap,
               choice = randomOf(key, Stream::Choice, i);
        const double w = target->bootstrapWeight(bootstrap) / functions.weightLimit();
        if (!(choice() < w) || !target->seed(again, choice(), chain.x)) continue;
        const double weight = std::max(1.0, w);
        kernel.enter(chain);
        std::vector<double> identities(tally.sum.size());
        const std::vector<double> first = functions(chain.x);
        std::vector<double> before = first;
        for (uint64_t s = 0; s < kStepsPerStart; ++s) {
            Random random = randomOf(key, Stream::Step, i * kStepsPerStart + s);
            StepContext context{random, target->tracing(), scene.limits};
            const uint64_t accepted = counter.accepted;
            kernel.step(chain, *target, context, counter);
            if (counter.accepted == accepted) continue;
            const std::vector<double> after = functions(chain.x);
            for (size_t a = 0, k = n; a < n; ++a)
                for (size_t b = a + 1; b < n; ++b) identities[k++] += before[a] * after[b] - before[b] * after[a];
            before = after;
        }
        for (size_t a = 0; a < n; ++a) identities[a] = before[a] - first[a];
        for (size_t k = 0; k < identities.size(); ++k) {
            const double value = weight * identities[k];
            tally.sum[k] += value, tally.squares[k] += value * value;
        }
        ++tally.starts, tally.steps += kStepsPerStart;
    }
    tally.accepted = counter.accepted;
    return tally;
}

std::vector<IdentityTest> identityTests(const TestFunctions& functions, const InvarianceTally& tally) {
    std::vector<IdentityTest> tests;
    const size_t n = functions.size();
    const auto add = [&](std::string name) {
        const size_t k = tests.size();
        const double z = tally.squares[k] > 0 ? tally.sum[k] / std::sqrt(tally.squares[k]) : 0;
        tests.push_back({std::move(name), z, std::erfc(std::abs(z) / std::numbers::sqrt2)});
    };
    for (size_t a = 0; a < n; ++a) add("change of " + functions.name(a));
    for (size_t a = 0; a < n; ++a)
        for (size_t b = a + 1; b < n; ++b) add("antisymmetry of " + functions.name(a) + " and " + functions.name(b));
    return tests;
}

}  // namespace ulam::audit
