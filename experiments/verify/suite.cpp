#include "experiments/verify/suite.h"

#include "core/base/error.h"
#include "core/mcmc/target.h"
#include "core/render/sampler.h"
#include "experiments/verify/mutation_audit.h"
#include "experiments/verify/sampler_audit.h"
#include "experiments/verify/target_audit.h"

namespace ulam::verify {
namespace {

/// One kind of subject: what was asked for, or all there is where nothing was.
struct Kind {
    std::string name;
    std::vector<std::string> asked, known;
    std::function<SubjectReport(const std::string&, size_t subjects)> audit;

    void checkNames() const {
        for (const std::string& subject : asked) {
            if (std::find(known.begin(), known.end(), subject) != known.end()) continue;
            const std::string hint = didYouMean(subject, known);
            fail(ExitCode::Usage, "unknown {} {}{}{}; known: {}", name, inQuotes(subject), hint.empty() ? "" : ", ",
                 hint, listInQuotes(known));
        }
    }
};

}  // namespace

Report verify(const Options& options) {
    Report report;
    report.seed = options.seed;
    report.level = options.level == Level::Full ? "full" : "quick";
    const Work work = options.level == Level::Full ? fullWork() : quickWork();
    References references(work, options.seed, options.threads);
    size_t asked = 0, subjects = 0;
    const auto settings = [&](const std::string& name, size_t ofItsKind) {
        const auto progress = [&, name](double done, const std::string& what) {
            options.progress((double(report.subjects.size()) + done) / double(subjects), fmt::format("{}: {}", name, what));
        };
        return AuditSettings{work, options.seed, options.threads, ofItsKind, options.stopAtFirst, progress};
    };
    std::vector<Kind> kinds{
        {"kernel", options.kernels, {"metropolis_hastings"}, [](const std::string& name, size_t) { return auditKernel(name); }},
        {"target", options.targets, Registry<Importance>::instance().names(),
         [&](const std::string& name, size_t n) { return auditTarget(name, settings(name, n), references); }},
        {"mutation", options.mutations, Registry<Mutation>::instance().names(),
         [&](const std::string& name, size_t n) { return auditMutation(name, settings(name, n), references); }},
        {"sampler", options.samplers, Registry<Sampler>::instance().names(),
         [&](const std::string& name, size_t n) { return auditSampler(name, settings(name, n), references); }}};
    for (const Kind& kind : kinds) kind.checkNames(), asked += kind.asked.size();
    for (Kind& kind : kinds) {
        if (asked == 0) kind.asked = kind.known;
        subjects += kind.asked.size();
    }
    for (const Kind& kind : kinds)
        for (const std::string& name : kind.asked) {
            SubjectReport subject = kind.audit(name, kind.asked.size());
            subject.replay = fmt::format("ulam verify --{} {} --level {} --seed {}", kind.name, name, report.level, options.seed);
            if (options.finished) options.finished(subject);
            report.subjects.push_back(std::move(subject));
        }
    return report;
}

}  // namespace ulam::verify
