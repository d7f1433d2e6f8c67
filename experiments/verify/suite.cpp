#include "experiments/verify/suite.h"

#include "core/base/error.h"
#include "core/mcmc/sample.h"
#include "core/render/sampler.h"
#include "experiments/verify/mutation_audit.h"
#include "experiments/verify/sampler_audit.h"

namespace ulam::verify {
namespace {

template <class Interface>
std::vector<std::string> registeredNames() {
    std::vector<std::string> names;
    for (const auto* entry : Registry<Interface>::instance().entries()) names.push_back(entry->name);
    return names;
}

template <class Interface>
void checkNames(const std::vector<std::string>& names) {
    const std::vector<std::string> known = registeredNames<Interface>();
    for (const std::string& name : names) {
        if (std::find(known.begin(), known.end(), name) != known.end()) continue;
        const std::string hint = didYouMean(name, known);
        fail(ExitCode::Usage, "unknown {} {}{}{}; known: {}", Interface::kind(), inQuotes(name),
             hint.empty() ? "" : ", ", hint, listInQuotes(known));
    }
}

}  // namespace

Report verify(const Options& options) {
    checkNames<Mutation>(options.mutations);
    checkNames<Sampler>(options.samplers);
    const bool everything = options.mutations.empty() && options.samplers.empty();
    const auto mutations = everything ? registeredNames<Mutation>() : options.mutations;
    const auto samplers = everything ? registeredNames<Sampler>() : options.samplers;

    Report report;
    report.seed = options.seed;
    report.level = options.level == Level::Full ? "full" : "quick";
    const Work work = options.level == Level::Full ? fullWork() : quickWork();
    const size_t subjects = mutations.size() + samplers.size();
    References references(work, options.seed, options.threads);
    const auto add = [&](SubjectReport subject) {
        subject.replay = fmt::format("ulam verify --{} {} --level {} --seed {}", subject.kind, subject.name,
                                     report.level, options.seed);
        if (options.finished) options.finished(subject);
        report.subjects.push_back(std::move(subject));
    };
    const auto announce = [&](const std::string& what) {
        if (options.progress) options.progress(double(report.subjects.size()) / double(subjects), what);
    };
    for (const std::string& mutation : mutations) {
        announce(mutation);
        add(auditMutation(mutation, AuditSettings{work, options.seed, options.threads, mutations.size(), options.stopAtFirst}, references));
    }
    for (const std::string& sampler : samplers) {
        announce(sampler);
        add(auditSampler(sampler, AuditSettings{work, options.seed, options.threads, samplers.size(), options.stopAtFirst}, references));
    }
    return report;
}

}  // namespace ulam::verify
