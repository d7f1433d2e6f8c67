#include "core/mcmc/kernel.h"

#include <cmath>

namespace ulam {

namespace {

double sumOf(const PrimaryVector& u) {
    double sum = 0;
    for (const NumberStream s : {NumberStream::Light, NumberStream::Camera, NumberStream::Connect})
        for (int i = 0; i < u.size(s); ++i)
            for (const double x : u(s, i)) sum += x;
    return sum;
}

}  // namespace

void Kernel::enter(Chain& chain) const {
    chain.suitability.resize(mix_.size());
    chain.z = mix_.suitabilities(chain.x, chain.suitability);
}

double Kernel::logRatio(const Chain& chain, int mutation, const Proposal& p, Space target, double logTechnique, double suitabilityY,
                        double zY) const {
    const Sample& x = chain.x;
    double r = p.y.logTarget - x.logTarget + p.logReverse - p.logForward + p.logJacobian;
    r += std::log(suitabilityY * chain.z / (zY * chain.suitability[size_t(mutation)]));
    const Space space = mix_[size_t(mutation)].mutation->space();
    if (space == Space::Primary && target == Space::Path) r += x.logDensity - p.y.logDensity + logTechnique;
    return r;
}

void Kernel::step(Chain& chain, Target& target, StepContext& context, StepObserver& observer) {
    ++chain.step;
    takeCause();  // of what came before
    StepInfo info;
    if (!(chain.z > 0)) {
        checkFinite(Cause::Mutation, chain.z);
        info.cause = takeCause();
        observer.observe(chain, Proposal(Reject::ZeroTarget), info);
        return;
    }
    double u = context.random() * chain.z;
    for (size_t i = 0; i < mix_.size(); ++i) {
        if (chain.suitability[i] > 0) info.mutation = int(i);
        if ((u -= chain.suitability[i]) < 0) break;
    }
    const Mutation& mutation = *mix_[size_t(info.mutation)].mutation;

    const bool primary = mutation.space() == Space::Primary, onPaths = target.space() == Space::Path;
    double logTechnique = 0;
    if (primary && onPaths) {
        // The technique is an auxiliary variable with law c(·|x), drawn afresh.
        const double c = target.redrawTechnique(chain.x, context.random, !mutation.isLargeStep());
        if (!std::isfinite(c)) {
            info.cause = takeCause();
            info.reject = info.cause == Cause::None ? Reject::NotInvertible : Reject::NotFinite;
            observer.observe(chain, Proposal(info.reject), info);
            return;
        }
        logTechnique = -c;
    }

    Proposal proposal = mutation.propose(chain.x, context);
    info.reject = proposal.reject;
    double zY = 0;
    if (info.reject == Reject::None) {
        if (primary && !checkFinite(Cause::Mutation, sumOf(proposal.y.u))) {
            info.reject = Reject::NotFinite;
        } else if (primary) {
            proposal.y.technique = chain.x.technique;
            info.reject = target.evaluateNumbers(proposal.y, context.random);
            if (info.reject == Reject::None && onPaths) logTechnique += target.logTechnique(proposal.y);
        } else {
            proposal.y.u.clear();
            info.reject = target.evaluatePath(proposal.y);
        }
    }
    if (info.reject == Reject::None) {
        zY = mix_.suitabilities(proposal.y, scratch_);
        const double suitabilityY = scratch_[size_t(info.mutation)];
        if (checkFinite(Cause::Mutation, zY) && suitabilityY > 0) {
            const double r = logRatio(chain, info.mutation, proposal, target.space(), logTechnique, suitabilityY, zY);
            constexpr double kImpossible = -std::numeric_limits<double>::infinity();  // to come back, say: α = 0
            if (r == kImpossible || checkFinite(Cause::Mutation, r)) info.acceptance = r >= 0 ? 1 : std::exp(r);
        }
    }
    info.cause = takeCause();
    if (info.cause != Cause::None) {
        info.reject = Reject::NotFinite;
        info.acceptance = 0;
    }
    proposal.reject = info.reject;
    info.accepted = info.acceptance > 0 && context.random() < info.acceptance;
    observer.observe(chain, proposal, info);
    if (info.accepted) {
        chain.x = proposal.y;
        chain.suitability.swap(scratch_);
        chain.z = zY;
    }
}

}  // namespace ulam
