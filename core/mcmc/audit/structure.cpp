#include "core/mcmc/audit/structure.h"

#include "core/base/archive.h"
#include "core/path/validate.h"

namespace ulam::audit {
namespace {

// More than a proposal uses; what a script does not cover is drawn as usual.
constexpr size_t kScriptBlocks = 48;
constexpr double kSmallest = 0x1p-33, kLargest = 1 - 0x1p-33;

bool extreme(uint64_t trial) {
    return trial % 16 >= 12;
}

/// The random numbers of a trial: ordinary for three quarters of them, then all smallest, all largest, or each of
/// either kind or ordinary.
std::vector<Block> scriptOf(RandomKey key, uint64_t trial) {
    std::vector<Block> script;
    if (!extreme(trial)) return script;
    const uint64_t kind = trial % 16;
    Random values = randomOf(key, Stream::Structure, trial), choices = randomOf(key, Stream::Edges, trial);
    for (size_t b = 0; b < kScriptBlocks; ++b) {
        script.push_back(values.nextBlock());
        for (double& u : script.back()) {
            const double choice = kind == 12 ? 0 : kind == 13 ? 0.2 : choices();
            u = choice < 0.15 ? kSmallest : choice < 0.3 ? kLargest : u;
        }
    }
    return script;
}

/// Does the state hold numbers that its evaluation does not ask for? (Those it asks for are put back where they are cut.)
bool holdsUnused(Target& target, const Sample& y, Random random) {
    for (int s = 0; s < kStreams; ++s) {
        const auto stream = NumberStream(s);
        if (y.u.size(stream) == 0) continue;
        Sample cut = y;
        cut.u.truncate(stream, y.u.size(stream) - 1);
        target.evaluateNumbers(cut, random);
        // What is drawn anew may end the walk earlier, but not before it is asked for.
        if (cut.u.size(stream) < y.u.size(stream)) return true;
    }
    return false;
}

bool sameFactors(const Scene& scene, const Sample& y) {
    Sample again;
    again.path = y.path;
    if (!evaluate(scene, again.path, again.factors)) return false;
    Sample stated;
    stated.path = y.path;
    stated.factors = y.factors;
    return bytesOf(again) == bytesOf(stated);
}

class Trial : StepObserver {
public:
    Trial(const AuditScene& scene, const Subject& subject, RandomKey key, StructureTally& tally, StepObserver* watcher)
        : scene_(scene),
          subject_(subject),
          key_(key),
          target_(subject.makeTarget(scene)),
          kernel_(subject.mix()),
          tally_(tally),
          watcher_(watcher) {}

    void run(const Sample& state, uint64_t trial) {
        trial_ = trial;
        ++tally_.trials;
        chain_.x = state;
        const bool primary = subject_.mutation().space() == Space::Primary;
        if (primary && subject_.target() == Space::Path) {
            Random random = randomOf(key_, Stream::Normal, trial);
            if (!std::isfinite(target_->redrawTechnique(chain_.x, random, !subject_.mutation().isLargeStep()))) return;
        }
        const std::vector<Block> script = scriptOf(key_, trial);
        propose(script, primary);

        kernel_.enter(chain_);
        Random random(key_, uint32_t(Stream::Structure), trial, script);
        StepContext context{random, target_->tracing(), scene_.limits};
        kernel_.step(chain_, *target_, context, *this);

        check(bytesOf(chain_.x) == next_, "the state after the step is neither the old one nor the proposal");
        Chain fresh;
        fresh.x = chain_.x;
        kernel_.enter(fresh);
        check(fresh.z == chain_.z && fresh.suitability == chain_.suitability, "the suitabilities kept with the state are not its own");
    }

private:
    void propose(const std::vector<Block>& script, bool primary) {
        const Sample& x = chain_.x;
        const std::string before = bytesOf(x);
        Random first(key_, uint32_t(Stream::Structure), trial_, script), second = first;
        StepContext context{first, target_->tracing(), scene_.limits},
            repeated{second, target_->tracing(), scene_.limits};
        Proposal p = subject_.mutation().propose(x, context);
        const Proposal q = subject_.mutation().propose(x, repeated);
        check(bytesOf(x) == before, "propose changed the current state");
        check(p.reject == q.reject, "the same seed was rejected for another reason");
        if (p.reject != Reject::None) {
            ++tally_.rejected[size_t(p.reject)];
            return;
        }
        ++tally_.proposals;
        check(bytesOf(p.y) == bytesOf(q.y), "the same seed gave another proposal");
        const std::array<double, 3> logs{p.logForward, p.logReverse, p.logJacobian},
            again{q.logForward, q.logReverse, q.logJacobian};
        check(std::equal(logs.begin(), logs.end(), again.begin()),
              "the same seed gave other densities, or they are not numbers");
        if (primary) {
            p.y.technique = x.technique;
            if (target_->evaluateNumbers(p.y, first) != Reject::None) return;
        }
        if (subject_.target() == Space::Primary) {
            check(!holdsUnused(*target_, p.y, first), "the state holds numbers that its evaluation does not use");
            return;
        }
        const auto violation = validate(target_->tracing(), scene_.limits, p.y.path, p.y.factors);
        if (violation)
            fail(*violation);
        else
            check(sameFactors(scene_.scene, p.y), "the factors differ from those computed from scratch");
    }

    void observe(const Chain& before, const Proposal& proposal, const StepInfo& info) override {
        if (watcher_) watcher_->observe(before, proposal, info);
        next_ = bytesOf(info.accepted ? proposal.y : before.x);
        check(info.acceptance >= 0 && info.acceptance <= 1, fmt::format("acceptance {}", info.acceptance));
        tally_.notFinite += info.reject == Reject::NotFinite && !extreme(trial_);
        if (info.reject != Reject::None) return;
        check(std::isfinite(proposal.y.logTarget), fmt::format("log target {}", proposal.y.logTarget));
        for (int i = 0; i < proposal.y.splats.size(); ++i)
            check(isFinite(proposal.y.splats[i].value) && std::isfinite(proposal.y.splats[i].raster.length2()),
                  "a splat is not finite");
    }

    void check(bool good, const std::string& message) {
        if (!good) fail(message);
    }
    void fail(const std::string& message) {
        tally_.failures.add(trial_, fmt::format("{} (state {})", message, pathClass(chain_.x.path)));
    }

    const AuditScene& scene_;
    const Subject& subject_;
    RandomKey key_;
    std::unique_ptr<Target> target_;
    Kernel kernel_;
    StructureTally& tally_;
    StepObserver* watcher_;
    Chain chain_;
    std::string next_;  ///< the state that the step ends with
    uint64_t trial_ = 0;
};

}  // namespace

void StructureTally::merge(const StructureTally& later) {
    trials += later.trials, proposals += later.proposals, notFinite += later.notFinite;
    for (size_t i = 0; i < rejected.size(); ++i) rejected[i] += later.rejected[i];
    failures.merge(later.failures);
}

StructureTally auditStructure(const AuditScene& scene, const Subject& subject, const States& states, RandomKey key,
                              uint64_t begin, uint64_t end, StepObserver* watcher) {
    StructureTally tally;
    Trial trial(scene, subject, key, tally, watcher);
    for (uint64_t t = begin; t < end; ++t) trial.run(states.x[t % states.x.size()], t);
    return tally;
}

}  // namespace ulam::audit
