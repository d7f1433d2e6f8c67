#include "experiments/engine/tuning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/config/json_number.h"
#include "experiments/engine/cell_errors.h"
#include "experiments/engine/result.h"
#include "experiments/statistics/moments.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

std::string samplerOf(const JsonNode& node, const std::string& path) {
    const std::vector<std::string> steps = pathSteps(path);
    if (steps.size() < 3 || steps[0] != "samplers")
        node.fail(fmt::format("{} is no parameter of a sampler", inQuotes(path)), "name it samplers.NAME.PARAMETER");
    return steps[1];
}

std::string candidateName(std::size_t candidate) {
    return fmt::format("c{}", candidate);
}

Json valuesJson(const SweepPoint& point) {
    Json values = Json::object();
    for (const SweepValue& value : point) values[value.path] = value.value;
    return values;
}

/// A reference made by a sampler of the experiment names it; the candidates stand in its place.
void spellOutSampler(Json& reference, const Json& samplers) {
    if (!reference.is_object()) return;
    if (!reference.contains("sampler")) {
        for (Json& ofScene : reference) spellOutSampler(ofScene, samplers);
        return;
    }
    Json& sampler = reference["sampler"];
    if (!sampler.is_string() || !samplers.contains(sampler.get<std::string>())) return;
    if (Registry<Sampler>::instance().contains(sampler.get<std::string>())) return;
    sampler = Json(samplers[sampler.get<std::string>()]);
}

/// A dry run tells of what cannot be run, too.
void checkCandidates(const JsonDocument& experiment, const std::vector<SweepPoint>& candidates) {
    const fs::path folder = fs::path(experiment.name()).parent_path();
    for (const SweepPoint& point : candidates) {
        JsonDocument candidate = experiment;
        for (const SweepValue& value : point)
            candidate.set(value.path, value.value, fmt::format("tune.sweep {}={}", value.path, value.value.dump()));
        parseExperiment(candidate.root(), folder, "tuning");
    }
}

/// By candidate, the mean over the scenes of the log of the mean error; infinite for one that failed.
std::map<std::size_t, double> scores(const Plan& plan, const fs::path& runDir, const std::vector<std::size_t>& candidates) {
    std::map<std::string, std::vector<double>> logs;
    for (const Cell& cell : plan.cells) {
        const Reference reference = readReference(plan.references[cell.reference], runDir);
        const std::vector<double> errors = cellErrors(plan, cell, reference, runDir).errors;
        if (errors.size() < std::size_t(cell.task.replicates)) {
            logs[cell.task.sampler].push_back(std::numeric_limits<double>::infinity());
            continue;
        }
        const double error = statistics::mean(errors);
        if (!(error > 0))
            fail(ExitCode::InvalidConfig, "{}: the reference is too poor to tune with: the error came out as {:.2g}",
                 cell.task.name, error);
        logs[cell.task.sampler].push_back(std::log(error));
    }
    std::map<std::size_t, double> found;
    for (const std::size_t c : candidates) found[c] = statistics::mean(logs.at(candidateName(c)));
    return found;
}

}  // namespace

std::optional<Tuning> plannedTuning(JsonDocument& experiment) {
    const JsonNode root = experiment.root();
    const auto node = root.isObject() ? root.find("tune") : std::nullopt;
    if (!node) return {};
    Tuning tuning;
    tuning.parameters = parseParameters<TuneParameters>(*node, {});
    const JsonNode sweep = node->at("sweep");
    tuning.candidates = expandSweep(sweep, root);
    for (const SweepValue& value : tuning.candidates.front()) {
        const std::string sampler = samplerOf(sweep, value.path);
        if (tuning.sampler.empty()) tuning.sampler = sampler;
        if (sampler != tuning.sampler)
            sweep.fail(fmt::format("one sampler is tuned, found parameters of {} and {}", inQuotes(tuning.sampler),
                                   inQuotes(sampler)));
    }
    if (tuning.candidates.size() < 2) sweep.expected("at least two candidates");
    if (const auto swept = root.find("sweep")) {
        const SweepPoint first = expandSweep(*swept, root).front();
        for (const SweepValue& value : first)
            for (const SweepValue& tuned : tuning.candidates.front())
                if ((value.path + ".").starts_with(tuned.path + ".") || (tuned.path + ".").starts_with(value.path + "."))
                    swept->fail(fmt::format("{} is swept and tuned: the sweep would overwrite what was chosen", inQuotes(value.path)));
    }
    const std::string untuned = tuning.sampler + "_untuned";
    const JsonNode samplers = root.at("samplers");
    if (const auto taken = samplers.find(untuned)) taken->fail(fmt::format("{} names the sampler before tuning", inQuotes(untuned)));
    experiment.set("samplers." + untuned, samplers.at(tuning.sampler).json(), "the sampler before tuning");
    checkCandidates(experiment, tuning.candidates);
    return tuning;
}

std::vector<TuningRound> tuningRounds(const Tuning& tuning) {
    const auto reduction = static_cast<std::size_t>(tuning.parameters.reduction);
    std::vector<TuningRound> rounds;
    for (std::size_t left = tuning.candidates.size(); left > 1; left = (left + reduction - 1) / reduction)
        rounds.push_back({1, left});
    for (std::size_t k = 0; k < rounds.size(); ++k)
        rounds[k].fraction = std::pow(1.0 / static_cast<double>(reduction), static_cast<double>(rounds.size() - 1 - k));
    return rounds;
}

JsonDocument roundExperiment(const JsonDocument& experiment, const Tuning& tuning, std::size_t round,
                             const std::vector<std::size_t>& candidates) {
    const Json& whole = experiment.json();
    Json json = whole;
    for (const char* key : {"sweep", "tune", "until", "baseline"}) json.erase(key);
    json["name"] = fmt::format("tuning_round_{}", round + 1);
    json["seed"] = hash64(fmt::format("tuning {} {}", whole.value("seed", Json(1)).dump(), round)) >> 12;
    json["replicates"] = tuning.parameters.replicates;
    json["snapshots"] = 0;
    if (json.contains("metrics")) json["metrics"] = Json::array({json["metrics"][0]});
    const double fraction = tuningRounds(tuning)[round].fraction;
    for (Json& limit : json["budget"]) limit = limit.get<double>() * fraction;
    spellOutSampler(json["reference"], whole["samplers"]);
    json["samplers"] = Json::object();
    for (const std::size_t c : candidates) {
        Json changed = whole;
        for (const SweepValue& value : tuning.candidates[c]) setValueByPath(changed, value.path, value.value);
        json["samplers"][candidateName(c)] = changed["samplers"][tuning.sampler];
    }
    return JsonDocument::fromText(dump(json), fmt::format("{}, round {} of tuning", experiment.name(), round + 1));
}

TuningOutcome tune(const JsonDocument& experiment, const fs::path& file, const Tuning& tuning, const RunOptions& options,
                   const std::atomic<bool>& interrupt, Progress& progress) {
    TuningOutcome outcome{.experiment = experiment, .record = {{"sampler", tuning.sampler}}};
    Json all = Json::array(), rounds = Json::array();
    for (const SweepPoint& point : tuning.candidates) all.push_back({{"values", valuesJson(point)}, {"scores", Json::array()}});
    std::vector<std::size_t> left(tuning.candidates.size());
    std::iota(left.begin(), left.end(), std::size_t{0});
    for (const TuningRound& round : tuningRounds(tuning)) {
        const std::size_t k = rounds.size();
        Plan plan = makePlan(roundExperiment(experiment, tuning, k, left), file);
        RunOptions own = options;
        own.runDir = options.runDir / "tuning" / fmt::format("round{}", k + 1);
        own.keepGoing = true;
        progress.message(fmt::format("tuning {}, round {}: {} candidates at {:.3g} of the budget", tuning.sampler, k + 1,
                                     left.size(), round.fraction));
        const RunOutcome ran = runPlan(plan, own, interrupt, progress);
        if (ran.interrupted) {
            outcome.interrupted = true;
            return outcome;
        }
        for (const Failure& failure : ran.failures)
            if (failure.cell.empty()) fail(ExitCode::SomeCellsFailed, "tuning: the reference of {} failed: {}", failure.scene, failure.message);
        const auto found = scores(plan, own.runDir, left);
        if (std::ranges::none_of(found, [](const auto& entry) { return std::isfinite(entry.second); }))
            fail(ExitCode::SomeCellsFailed, "tuning: every candidate failed: {}", ran.failures.front().message);
        for (const auto& [candidate, score] : found) all[candidate]["scores"].push_back(numberOrNull(score));
        std::ranges::stable_sort(left, {}, [&](std::size_t c) { return found.at(c); });
        const auto reduction = static_cast<std::size_t>(tuning.parameters.reduction);
        left.resize((left.size() + reduction - 1) / reduction);
        rounds.push_back({{"candidates", round.candidates},
                          {"budget", plan.experiment["budget"]},
                          {"replicates", tuning.parameters.replicates},
                          {"kept", left}});
    }
    const SweepPoint& winner = tuning.candidates[left.front()];
    for (const SweepValue& value : winner)
        outcome.experiment.set(value.path, value.value, fmt::format("tuned {}={}", value.path, value.value.dump()));
    outcome.record["winner"] = valuesJson(winner);
    outcome.record["rounds"] = std::move(rounds);
    outcome.record["candidates"] = std::move(all);
    writeFileAtomically(options.runDir / "tuning" / "tuning.json", dump(outcome.record) + "\n");
    return outcome;
}

}  // namespace ulam
