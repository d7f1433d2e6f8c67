// ulam replay-path: one sample or step of a run, or one trial of the audit, made again and told in full.

#include "core/base/error.h"
#include "experiments/cli/commands.h"
#include "experiments/cli/render_job.h"
#include "experiments/engine/path_token.h"
#include "experiments/verify/trial_token.h"

namespace ulam {
namespace {

bool isShort(const Json& value) {
    if (!value.is_structured()) return true;
    return value.is_array() && value.size() <= 4 && std::all_of(value.begin(), value.end(), [](const Json& v) { return !v.is_structured(); });
}

/// As indented lines, lists numbered.
void print(const Json& value, int indent) {
    size_t index = 0;
    for (const auto& [key, one] : value.items()) {
        const std::string label = value.is_array() ? std::to_string(index++) : key;
        if (isShort(one)) {
            fmt::print("{:{}}{}: {}\n", "", indent, label, one.is_string() ? one.get<std::string>() : one.dump());
        } else if (one.is_array() && isShort(one.front()) && !one.front().is_structured()) {
            fmt::print("{:{}}{}: {}\n", "", indent, label, one.dump());
        } else {
            fmt::print("{:{}}{}:\n", "", indent, label);
            print(one, indent + 4);
        }
    }
}

void tell(const Json& told, bool json) {
    if (json) fmt::print("{}\n", dump(told));
    else print(told, 0);
}

void replayPath(const std::string& word, bool json) {
    if (word.starts_with(verify::kTrialPrefix)) return tell(verify::replayTrial(word), json);
    const PathToken token = readPathToken(word);
    const RenderJob job = jobOf(JsonNode(token.repeat));
    const Scene scene = buildScene(job, {});
    if (scene.hash != token.sceneHash) fail(ExitCode::InvalidConfig, "the scene is not the one that the token is of: a file has changed");
    const auto sampler = Registry<Sampler>::instance().create(job.sampler.root());
    const auto run = sampler->start({.scene = scene, .key = token.key, .workers = 1, .expectedUnits = 0, .expectedSeconds = 0, .expectedRays = 0});
    Json told = {{"cause", token.event.cause}};
    told.update(run->replay(token.event));
    tell(told, json);
}

}  // namespace

void addReplayPathCommand(CLI::App& app) {
    auto token = std::make_shared<std::string>();
    auto json = std::make_shared<bool>(false);
    CLI::App& command = *app.add_subcommand(
        "replay-path", "make one sample or step of a run, or one trial of the audit, again, and print its paths with densities and contribution");
    command.add_option("token", *token, "as results and messages have it")->type_name("TOKEN")->required();
    command.add_flag("--json", *json, "as JSON");
    addPluginOption(command);
    addResourceOption(command);
    command.callback([token, json] { replayPath(*token, *json); });
}

}  // namespace ulam
