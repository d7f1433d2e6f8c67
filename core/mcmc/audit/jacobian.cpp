#include "core/mcmc/audit/jacobian.h"

#include <algorithm>

#include "core/path/primary_map.h"

namespace ulam::audit {
namespace {

// Standard error of the median of normal values, from their median absolute deviation and the root of their number.
const double kMedianError = 1.4826 * std::sqrt(kPi / 2);
constexpr const char* kSeveralBranches = " (one branch of several)";

double quantile(std::vector<double> values, double q) {
    const auto place = values.begin() + std::ptrdiff_t(q * double(values.size()));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}
double median(const std::vector<double>& values) {
    return quantile(values, 0.5);
}

bool isSpecular(const Path& x) {
    for (int i = 0; i < x.size(); ++i)
        if (isDelta(x[i].lobe)) return true;
    return false;
}
/// The largest between vertices of the same number.
double distance(const Path& x, const Path& y) {
    double largest = 0;
    for (int i = 0; i < x.size(); ++i) largest = std::max(largest, double(length(x[i].position - y[i].position)));
    return largest;
}

class Comparer {
public:
    Comparer(const AuditScene& scene, const Subject& subject, RandomKey key, JacobianTally& tally, StepObserver* watcher)
        : scene_(scene), subject_(subject), key_(key), target_(subject.makeTarget(scene)), tally_(tally), watcher_(watcher) {}

    void run(const Sample& x, uint64_t state, uint64_t trial) {
        state_ = state;
        if (subject_.mutation().space() == Space::Path)
            ofProposal(x, trial);
        else
            ofPrimaryMap(x, trial);
    }

private:
    void ofProposal(const Sample& x, uint64_t trial) {
        Random random = randomOf(key_, Stream::Jacobian, trial);
        StepContext context{random, target_->tracing(), scene_.limits};
        const Proposal p = subject_.mutation().propose(x, context);
        watch(x, p);
        if (p.reject != Reject::None) return;
        std::vector<Block> numbers;
        Random again = randomOf(key_, Stream::Jacobian, trial);
        while (numbers.size() < random.blocks()) numbers.push_back(again.nextBlock());
        const NumberMap map = [&](std::span<const Block> script, Path& path, PathFactors& factors) {
            Random replay(key_, uint32_t(Stream::Jacobian), trial, script);
            StepContext displaced{replay, target_->tracing(), scene_.limits};
            const Proposal q = subject_.mutation().propose(x, displaced);
            path = q.y.path;
            factors = q.y.factors;
            return q.reject == Reject::None;
        };
        compare(map, numbers, x.path, p.y.path, p.y.factors, p.logForward, trial);
    }

    void ofPrimaryMap(const Sample& state, uint64_t trial) {
        Sample x = state;
        Random random = randomOf(key_, Stream::Jacobian, trial);
        ++tally_.inversions;
        if (!std::isfinite(target_->redrawTechnique(x, random, true))) return;
        watch(x, {});
        std::vector<Block> numbers;
        for (int s = 0; s < kStreams; ++s)
            for (int i = 0; i < x.u.size(NumberStream(s)); ++i) numbers.push_back(x.u(NumberStream(s), i));
        const NumberMap map = [&](std::span<const Block> script, Path& path, PathFactors& factors) {
            PrimaryVector u;
            size_t next = 0;
            for (int s = 0; s < kStreams; ++s)
                for (int i = 0; i < x.u.size(NumberStream(s)); ++i) u.append(NumberStream(s), script[next++]);
            Random unused = randomOf(key_, Stream::Normal, trial);
            return makePath(target_->tracing(), scene_.limits, x.technique, u, unused, path) &&
                   evaluate(scene_.scene, path, factors);
        };
        Path path;
        PathFactors factors;
        if (!map(numbers, path, factors)) {
            if (tally_.notInverted++ == 0) tally_.firstNotInverted = trial;  // a few, at the edge of visibility
            return;
        }
        if (!isSpecular(x.path)) {
            ++tally_.plain;
            if (distance(x.path, path) > 0.5 * target_->tracing().offsetLength() && tally_.moved++ == 0) tally_.firstMoved = trial;
        }
        const double stated = densities(scene_.scene, scene_.limits, path, factors).log(x.technique.s);
        compare(map, numbers, Path(), path, factors, stated, trial);
    }

    /// The kernel takes no part: there is no acceptance.
    void watch(const Sample& x, const Proposal& p) {
        if (!watcher_) return;
        Chain chain;
        chain.x = x;
        watcher_->observe(chain, p, {.mutation = 0, .acceptance = std::numeric_limits<double>::quiet_NaN(), .reject = p.reject});
    }

    void compare(const NumberMap& map, const std::vector<Block>& numbers, const Path& origin, const Path& path,
                 const PathFactors& factors, double stated, uint64_t trial) {
        ++tally_.proposals;
        const Branch branch =
            findBranch(map, numbers, scene_.scene, origin, path, factors, randomOf(key_, Stream::Alternatives, trial));
        tally_.noisy += branch.outcome == Branch::Outcome::Noisy;
        tally_.notSquare += branch.outcome == Branch::Outcome::NotSquare;
        if (branch.outcome != Branch::Outcome::Resolved) return;
        const std::string key =
            fmt::format("{} {}{}", pathClass(path), branch.moved, branch.only ? "" : kSeveralBranches);
        tally_.classes[key].push_back({stated - branch.logDensity, branch.only, state_, trial});
    }

    const AuditScene& scene_;
    const Subject& subject_;
    RandomKey key_;
    std::unique_ptr<Target> target_;
    JacobianTally& tally_;
    StepObserver* watcher_;
    uint64_t state_ = 0;
};

}  // namespace

void JacobianTally::merge(const JacobianTally& later) {
    if (notInverted == 0) firstNotInverted = later.firstNotInverted;
    inversions += later.inversions, notInverted += later.notInverted;
    if (moved == 0) firstMoved = later.firstMoved;
    plain += later.plain, moved += later.moved;
    proposals += later.proposals, noisy += later.noisy, notSquare += later.notSquare;
    for (const auto& [key, comparisons] : later.classes)
        classes[key].insert(classes[key].end(), comparisons.begin(), comparisons.end());
}

JacobianTally auditJacobian(const AuditScene& scene, const Subject& subject, const States& states, RandomKey key,
                            uint64_t begin, uint64_t end, StepObserver* watcher) {
    JacobianTally tally;
    if (subject.target() == Space::Primary) return tally;
    Comparer comparer(scene, subject, key, tally, watcher);
    for (uint64_t t = begin; t < end; ++t) comparer.run(states.x[t % states.x.size()], states.source[t % states.x.size()], t);
    return tally;
}

namespace {

using Comparisons = std::vector<JacobianTally::Comparison>;

std::map<uint64_t, std::vector<double>> excessByState(const Comparisons& comparisons) {
    std::map<uint64_t, std::vector<double>> byState;
    for (const auto& c : comparisons) byState[c.state].push_back(c.excess);
    return byState;
}

/// Classes with too few states to be judged are put together with others of paths of their length: each alone may be
/// rare, as long paths are, and all be wrong.
std::map<std::string, Comparisons> judgedTogether(const JacobianTally& tally) {
    std::map<std::string, Comparisons> together;
    for (const auto& [key, comparisons] : tally.classes) {
        const std::string rare =
            fmt::format("{} vertices, rare shapes{}", key.find(' '), comparisons.front().only ? "" : kSeveralBranches);
        Comparisons& all = together[excessByState(comparisons).size() < kFewestStates ? rare : key];
        all.insert(all.end(), comparisons.begin(), comparisons.end());
    }
    return together;
}

}  // namespace

JacobianVerdict judge(const JacobianTally& tally) {
    JacobianVerdict verdict;
    if (double(tally.notInverted) > kNotInvertedShare * double(tally.inversions))
        verdict.failures.add(tally.firstNotInverted,
                             fmt::format("{} of {} states have no numbers that make them again", tally.notInverted, tally.inversions));
    if (double(tally.moved) > kMovedShare * double(tally.plain))
        verdict.failures.add(tally.firstMoved, fmt::format("{} of {} states move when they are made again from their numbers", tally.moved, tally.plain));
    for (const auto& [key, comparisons] : judgedTogether(tally)) {
        const auto byState = excessByState(comparisons);
        if (byState.size() < kFewestStates) {
            ++verdict.unjudged;
            continue;
        }
        ++verdict.classes;
        verdict.comparisons += comparisons.size();
        const bool only = comparisons.front().only;
        if (only) verdict.equalities += comparisons.size();
        // What one state says again and again is said once.
        std::vector<double> excess, distance, deviation;  // of states, of comparisons, of states
        for (const auto& [state, values] : byState) excess.push_back(median(values));
        const double shift = median(excess), wrong = only ? std::abs(shift) : std::max(0.0, -shift);
        for (const auto& c : comparisons) distance.push_back(std::abs(c.excess - shift));
        for (double e : excess) deviation.push_back(std::abs(e - shift));
        const double scatter = quantile(distance, kScatterQuantile);
        const double standardError = kMedianError * median(deviation) / std::sqrt(double(excess.size()));
        verdict.scatter = std::max(verdict.scatter, only ? scatter : 0);
        verdict.worst = std::max(verdict.worst, wrong);
        const bool scattered = only && excess.size() >= kFewestForScatter && !(scatter <= kJacobianScatter);
        if (scattered || !(wrong <= kJacobianTolerance + 4 * standardError))
            verdict.failures.add(
                comparisons.front().trial,
                fmt::format("log q(x → y) differs from the Jacobian of its random numbers: median "
                            "excess {:.4g} ± {:.2g}, scatter {:.2g}, of {} proposals from {} states {}",
                            shift, standardError, scatter, comparisons.size(), excess.size(), key));
    }
    return verdict;
}

}  // namespace ulam::audit
