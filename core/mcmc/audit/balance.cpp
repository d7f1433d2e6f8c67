#include "core/mcmc/audit/balance.h"

namespace ulam::audit {
namespace {

double difference(double a, double b) {
    return a == b ? 0 : std::abs(a - b);
}

class Step : StepObserver {
public:
    Step(const AuditScene& scene, const Subject& subject, RandomKey key, BalanceTally& tally, StepObserver* watcher)
        : scene_(scene),
          subject_(subject),
          key_(key),
          target_(subject.makeTarget(scene)),
          kernel_(subject.mix()),
          primary_(subject.mutation().space() == Space::Primary),
          tolerance_(primary_ && subject.target() == Space::Primary ? kPrimaryResidual : kPathResidual),
          tally_(tally),
          watcher_(watcher) {}

    void run(const Sample& state, uint64_t trial) {
        trial_ = trial;
        chain_.x = state;
        kernel_.enter(chain_);
        // The first number chooses the mutation: the subject, which comes first in the mix.
        std::vector<Block> script{randomOf(key_, Stream::Balance, trial).nextBlock()};
        script[0][0] = 0x1p-33;
        Random random(key_, uint32_t(Stream::Balance), trial, script);
        StepContext context{random, target_->tracing(), scene_.limits};
        context_ = &context;
        kernel_.step(chain_, *target_, context, *this);
    }

private:
    void observe(const Chain& before, const Proposal& p, const StepInfo& info) override {
        if (watcher_) watcher_->observe(before, p, info);
        if (info.mutation != 0) return;
        ++tally_.steps;
        if (info.reject != Reject::None) return;
        ++tally_.pairs;
        const auto forward = subject_.mutation().logDensity(before.x, p.y, *context_);
        const auto reverse = subject_.mutation().logDensity(p.y, before.x, *context_);
        if (!forward || !reverse) {
            tally_.hasDensity = false;
            return;
        }
        // A mutation that is symmetric may leave both at 0: then the two densities must be equal.
        if (p.logForward == 0 && p.logReverse == 0) {
            residual(difference(*forward, *reverse), [&] {
                return fmt::format("stated as symmetric, but log q(x → y) is {}, log q(y → x) {}", *forward, *reverse);
            });
        } else {
            residual(difference(p.logForward, *forward),
                     [&] { return fmt::format("logForward is {}, log q(x → y) afresh {}", p.logForward, *forward); });
            residual(difference(p.logReverse, *reverse),
                     [&] { return fmt::format("logReverse is {}, log q(y → x) afresh {}", p.logReverse, *reverse); });
        }
        if (!(*reverse > -std::numeric_limits<double>::infinity())) {
            residual(std::numeric_limits<double>::infinity(),
                     [&] { return std::string("the way back is impossible"); });
            return;
        }

        Chain here, there;
        here.x = before.x;
        there.x = p.y;
        kernel_.enter(here);
        kernel_.enter(there);
        const double logX = state(before.x), logY = state(p.y);
        const double selectX = std::log(here.suitability[0] / here.z),
                     selectY = std::log(there.suitability[0] / there.z);
        const double ratio = logY - logX + *reverse - *forward + p.logJacobian + selectY - selectX;
        // Where α is below the smallest normal number, few of its digits are left to take a log of.
        constexpr double kSmallest = std::numeric_limits<double>::min();
        const double expected = std::min(0.0, ratio);
        const double alpha = info.acceptance < kSmallest && std::exp(expected) < kSmallest ? expected : std::log(info.acceptance);
        residual(difference(alpha, expected), [&] { return fmt::format("log α is {}, by the balance {}", alpha, expected); });
        if (!(there.suitability[0] > 0)) return;

        Proposal back;
        back.y = before.x;
        back.logForward = *reverse;
        back.logReverse = *forward;
        back.logJacobian = -p.logJacobian;
        const double logTechnique =
            primary_ && subject_.target() == Space::Path ? technique(before.x) - technique(p.y) : 0;
        const double alphaBack = std::min(
            0.0, kernel_.logRatio(there, 0, back, subject_.target(), logTechnique, here.suitability[0], here.z));
        const double flow = logX + selectX + *forward + alpha,
                     flowBack = logY + selectY + *reverse + p.logJacobian + alphaBack;
        residual(difference(flow, flowBack),
                 [&] { return fmt::format("log f(x) q(x → y) α is {}, log f(y) q(y → x) α′ {}", flow, flowBack); });
    }

    /// The log of what the state's density in the mutation's space is proportional to, from scratch.
    double state(const Sample& s) {
        if (subject_.target() == Space::Primary) {
            Sample again;
            again.u = s.u;
            Random unused = randomOf(key_, Stream::Normal, trial_);
            return target_->evaluateNumbers(again, unused) == Reject::None ? again.logTarget
                                                                           : -std::numeric_limits<double>::infinity();
        }
        Sample again;
        again.path = s.path;
        again.technique = s.technique;
        if (!evaluate(scene_.scene, again.path, again.factors) || target_->evaluatePath(again) != Reject::None)
            return -std::numeric_limits<double>::infinity();
        if (!primary_) return again.logTarget;
        const double c = target_->logTechnique(again);
        return again.logTarget + c - again.logDensity;
    }

    double technique(const Sample& s) {
        Sample again = s;
        return target_->logTechnique(again);
    }

    template <class Message>
    void residual(double value, const Message& message) {
        if (!(value <= tally_.worst)) tally_.worst = value, tally_.worstTrial = trial_;
        if (!(value <= tolerance_))
            tally_.failures.add(trial_, fmt::format("{} (state {})", message(), pathClass(chain_.x.path)));
    }

    const AuditScene& scene_;
    const Subject& subject_;
    RandomKey key_;
    std::unique_ptr<Target> target_;
    Kernel kernel_;
    bool primary_;
    double tolerance_;
    BalanceTally& tally_;
    StepObserver* watcher_;
    Chain chain_;
    StepContext* context_ = nullptr;
    uint64_t trial_ = 0;
};

}  // namespace

void BalanceTally::merge(const BalanceTally& later) {
    steps += later.steps, pairs += later.pairs;
    hasDensity = hasDensity && later.hasDensity;
    if (!(later.worst <= worst)) worst = later.worst, worstTrial = later.worstTrial;
    failures.merge(later.failures);
}

BalanceTally auditBalance(const AuditScene& scene, const Subject& subject, const States& states, RandomKey key,
                          uint64_t begin, uint64_t end, StepObserver* watcher) {
    BalanceTally tally;
    Step step(scene, subject, key, tally, watcher);
    for (uint64_t t = begin; t < end; ++t) step.run(states.x[t % states.x.size()], t);
    return tally;
}

}  // namespace ulam::audit
