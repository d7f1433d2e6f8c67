#include "experiments/verify/trial_token.h"

#include "core/base/error.h"
#include "core/mcmc/audit/balance.h"
#include "core/mcmc/audit/jacobian.h"
#include "core/mcmc/audit/structure.h"
#include "core/render/replay.h"
#include "experiments/engine/token.h"

namespace ulam::verify {
namespace {

using namespace audit;

struct Describer : StepObserver {
    Describer(const AuditScene& auditScene, const Subject& auditSubject) : scene(auditScene), subject(auditSubject) {
        options.limits = scene.limits;
    }
    void observe(const Chain& before, const Proposal& proposal, const StepInfo& info) override {
        steps.push_back(describeStep(scene.scene, options, subject.mix(), before, proposal, info));
    }
    const AuditScene& scene;
    const Subject& subject;
    BidirectionalOptions options;
    Json steps = Json::array();
};

}  // namespace

std::string trialToken(const MutationCase& c, const Place& place, std::string_view check, uint64_t trial) {
    return packToken(kTrialPrefix, {{"mutation", c.name},
                                    {"scene", place.scene->name},
                                    {"paths", place.target == Space::Path},
                                    {"seed", c.settings.seed},
                                    {"samples", c.work().seedSamples},
                                    {"states", c.work().states},
                                    {"check", check},
                                    {"trial", trial}});
}

Json replayTrial(const std::string& token) {
    const JsonDocument document = unpackToken(kTrialPrefix, token);
    const JsonNode root = document.root();
    const std::string mutation = root.at("mutation").string(), sceneName = root.at("scene").string(), check = root.at("check").string();
    const uint64_t trial = root.at("trial").unsignedInteger();
    const Space target = root.at("paths").boolean() ? Space::Path : Space::Primary;
    Registry<Mutation>::instance().find(mutation, root.at("mutation"));
    const auto found = std::ranges::find(auditScenes(), sceneName, [](const auto& scene) { return scene->name; });
    if (found == auditScenes().end()) fail(ExitCode::Usage, "there is no audit scene {}", inQuotes(sceneName));
    const AuditScene& scene = **found;
    const RandomKey key = makeKey(root.at("seed").unsignedInteger(), cellOf(mutation));
    const Subject alone(mutation, target), mixed(mutation, target, partnersOf(mutation, target));
    const States states = drawStates(scene, alone, key, root.at("samples").unsignedInteger(), root.at("states").unsignedInteger());
    if (states.x.empty()) fail(ExitCode::Usage, "the mutation suits no state of the token's scene");

    const Subject& subject = check == "structure" || check == "balance" ? mixed : alone;
    Describer describer(scene, subject);
    Failures failures;
    if (check == "structure") {
        failures = auditStructure(scene, subject, states, key, trial, trial + 1, &describer).failures;
    } else if (check == "balance") {
        failures = auditBalance(scene, subject, states, key, trial, trial + 1, &describer).failures;
    } else if (check == "jacobian") {
        failures = judge(auditJacobian(scene, subject, states, key, trial, trial + 1, &describer)).failures;
    } else {
        Chain chain;
        chain.x = states.x[trial % states.x.size()];
        describer.observe(chain, {}, {.mutation = 0, .acceptance = std::numeric_limits<double>::quiet_NaN()});
    }
    Json told = {{"mutation", mutation}, {"scene", sceneName}, {"check", check}, {"trial", trial}, {"failures", Json::array()}};
    for (const Failure& failure : failures.first()) told["failures"].push_back(failure.message);
    told["steps"] = std::move(describer.steps);
    return told;
}

}  // namespace ulam::verify
