// ulam verify: the audit of mutations, samplers, kernels and targets.

#include "core/base/error.h"
#include "core/base/file.h"
#include "experiments/cli/arguments.h"
#include "experiments/cli/commands.h"
#include "experiments/engine/progress.h"
#include "experiments/verify/page.h"
#include "experiments/verify/suite.h"

namespace ulam {
namespace {

struct VerifyArguments {
    std::vector<std::string> mutations, samplers, kernels, targets;
    std::string level = "quick";
    std::shared_ptr<std::uint64_t> seed;
    std::shared_ptr<int> threads;
    bool stopAtFirst = false, json = false;
    std::string page;
};

void verifyRegistered(const VerifyArguments& a) {
    Progress progress(false);
    verify::Options options;
    options.mutations = a.mutations;
    options.samplers = a.samplers;
    options.kernels = a.kernels;
    options.targets = a.targets;
    options.level = a.level == "full" ? verify::Level::Full : verify::Level::Quick;
    options.seed = *a.seed;
    options.threads = *a.threads;
    options.stopAtFirst = a.stopAtFirst;
    options.progress = [&](double fraction, const std::string& what) { progress.update(fraction, what); };
    options.finished = [&](const verify::SubjectReport& subject) {
        if (a.json) return;
        progress.clear();
        verify::print(subject);
        std::fflush(stdout);
    };
    const verify::Report report = verify::verify(options);
    progress.clear();
    if (!a.page.empty()) writeFileAtomically(a.page, verify::toHtml(report));
    if (a.json) fmt::print("{}\n", dump(verify::toJson(report)));
    std::vector<std::string> rejected;
    for (const auto& subject : report.subjects)
        if (subject.rejected()) rejected.push_back(subject.kind + " " + subject.name);
    if (!rejected.empty()) fail(ExitCode::VerificationRejected, "rejected: {}", fmt::join(rejected, ", "));
}

}  // namespace

void addVerifyCommand(CLI::App& app) {
    auto a = std::make_shared<VerifyArguments>();
    CLI::App& command =
        *app.add_subcommand("verify", "audit mutations, samplers, kernels and targets; ends with code 3 where one is rejected");
    const auto names = [&](const char* option, std::vector<std::string>& target, const char* help) {
        command.add_option(option, target, help)->type_name("NAME");
    };
    names("--mutation", a->mutations, "mutations to audit (see: ulam list mutations)");
    names("--sampler", a->samplers, "samplers to audit (see: ulam list samplers)");
    names("--kernel", a->kernels, "kernels to audit (see: ulam list kernels)");
    names("--target", a->targets, "targets to audit (see: ulam list targets)");
    command.add_option("--level", a->level, "quick: about 20 s a mutation; full: as far as the audit goes")
        ->check(CLI::IsMember({"quick", "full"}))
        ->capture_default_str();
    a->seed = addSeedOption(command);
    a->threads = addThreadsOption(command);
    command.add_flag("--stop-at-first", a->stopAtFirst, "leave out the checks that follow a subject's first rejection");
    command.add_flag("--json", a->json, "as JSON");
    command.add_option("--page", a->page, "also write one HTML page with pictures")->type_name("FILE.html");
    addPluginOption(command);
    command.callback([a] { verifyRegistered(*a); });
}

}  // namespace ulam
