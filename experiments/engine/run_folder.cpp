#include "experiments/engine/run_folder.h"

#include <map>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/difference.h"
#include "core/config/json_text.h"
#include "experiments/engine/lease.h"
#include "experiments/engine/replicate.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostDifferences = 5;  // in a message

Json readResolved(const fs::path& runDir) {
    const fs::path file = runDir / "resolved.json";
    std::error_code ignored;
    if (!fs::exists(file, ignored))
        fail(ExitCode::InputMissing, "{} is no folder of a run: expected resolved.json in it, as ulam run writes it",
             runDir.string());
    return readOwnJson(file);
}

std::map<std::string, Json> cellsByName(const Json& resolved) {
    std::map<std::string, Json> cells;
    for (const Json& cell : resolved["cells"]) cells[cell["cell"].get<std::string>()] = cell;
    return cells;
}

/// Why two descriptions of a cell are of different work; empty where they are not.
std::string differenceOf(Json stored, Json wanted) {
    const bool sameTask = stored["task_hash"] == wanted["task_hash"];
    if (sameTask && stored["reference"] == wanted["reference"] && stored["replicates"] == wanted["replicates"])
        return "";
    for (Json* cell : {&stored, &wanted}) cell->erase("task_hash"), cell->erase("random_keys");
    // Keys of references tell of the program, too.
    if (stored == wanted) return "it was planned by another version of the program";
    const std::string difference = firstDifference(stored, wanted, "resolved.json");
    return stored["reference"] != wanted["reference"] && sameTask ? difference + ", as by another build of the program"
                                                                  : difference;
}

std::vector<std::string> differences(const Json& stored, const Json& wanted) {
    std::vector<std::string> found;
    const auto before = cellsByName(stored), now = cellsByName(wanted);
    for (const auto& [name, cell] : before) {
        const auto same = now.find(name);
        if (same == now.end())
            found.push_back(fmt::format("cell {} is in resolved.json only", name));
        else if (const std::string difference = differenceOf(cell, same->second); !difference.empty())
            found.push_back(fmt::format("cell {}: {}", name, difference));
    }
    for (const auto& [name, cell] : now)
        if (!before.contains(name)) found.push_back(fmt::format("cell {} is not in resolved.json", name));
    return found;
}

/// Those that "until" has asked for. Never fewer than there are: a run that is resumed begins with its first ones.
void addReplicates(Plan& plan, const Json& resolved) {
    if (!plan.until) return;
    const auto stored = cellsByName(resolved);
    for (Cell& cell : plan.cells)
        if (const auto same = stored.find(cell.task.name); same != stored.end())
            cell.task.replicates = std::max(cell.task.replicates, same->second["replicates"].get<int>());
}

/// The replicates of a task, by what became of them.
Json statusOfTask(const Json& task, const fs::path& folder) {
    Json running = Json::array(), expired = Json::array(), failed = Json::array();
    int done = 0, missing = 0;
    const int replicates = task["replicates"];
    for (int r = 0; r < replicates; ++r) {
        const fs::path place = replicateFolder(folder, r);
        std::error_code ignored;
        if (fs::exists(place / "result.json", ignored)) {
            const Json result = Json::parse(readFile(place / "result.json"), nullptr, false);
            if (result.is_object() && result.value("task_hash", Json()) == task["task_hash"]) {
                ++done;
                continue;
            }
        }
        const auto holder = leaseHolder(place);
        const auto failure = recordedFailure(place);
        const auto held = [&] {
            return Json{{"replicate", r},         {"host", holder->host}, {"process", holder->process},
                        {"since", holder->since}, {"job", holder->job},   {"idle_seconds", holder->idle}};
        };
        if (holder && !holder->expired)
            running.push_back(held());
        else if (failure)
            failed.push_back(
                {{"replicate", r}, {"message", failure->message}, {"host", failure->host}, {"time", failure->time}});
        else if (holder)
            expired.push_back(held());
        else
            ++missing;
    }
    return {{"replicates", replicates}, {"done", done},       {"missing", missing},
            {"running", running},       {"expired", expired}, {"failed", failed}};
}

Json statusOfReference(const std::string& key, const Json& reference, const fs::path& folder) {
    Json status = {{"reference", key}};
    if (reference.contains("scene")) status["scene"] = reference["scene"];
    std::error_code ignored;
    if (fs::exists(folder / "result.json", ignored)) {
        const Json result = Json::parse(readFile(folder / "result.json"), nullptr, false);
        // One that is being extended has fewer parts than are asked for.
        if (result.is_object() && result.value("replicates", 0) >= reference.value("replicates", 0)) {
            status["state"] = "ready";
            return status;
        }
    }
    const auto failure = recordedFailure(folder);
    status["state"] = failure ? "failed" : "unfinished";
    if (failure) status.update(Json{{"message", failure->message}, {"host", failure->host}, {"time", failure->time}});
    if (reference.contains("task_hash")) status["parts"] = statusOfTask(reference, folder / "parts");
    return status;
}

}  // namespace

Json readOwnJson(const fs::path& file) {
    return parseJson(readFile(file), file.string());
}

Plan planOfRun(const fs::path& runDir) {
    const Json resolved = readResolved(runDir);
    Plan plan = makePlan(JsonDocument::fromFile(runDir / "experiment.json"), resolved["source"].get<std::string>());
    addReplicates(plan, resolved);
    const std::vector<std::string> found = differences(resolved, plan.resolved());
    if (!found.empty())
        fail(ExitCode::InvalidConfig,
             "this program plans other work than {} says: {}{}; work with the program that began the run, or let ulam "
             "run --resume plan it anew",
             (runDir / "resolved.json").string(),
             fmt::join(found.begin(), found.begin() + std::ptrdiff_t(std::min(found.size(), kMostDifferences)), "; "),
             found.size() > kMostDifferences ? fmt::format("; and {} more", found.size() - kMostDifferences) : "");
    return plan;
}

std::vector<Plan::Replicate> addedReplicates(Plan& plan, const fs::path& runDir) {
    const std::vector<int> before = plan.replicatesOfCells();
    if (plan.until) addReplicates(plan, readResolved(runDir));
    return plan.order(before);
}

Json statusOfRun(const fs::path& runDir) {
    const Json resolved = readResolved(runDir);
    Json references = Json::array(), cells = Json::array(),
         totals = {{"replicates", 0}, {"done", 0}, {"missing", 0}, {"running", 0}, {"expired", 0}, {"failed", 0}};
    for (const auto& [key, reference] : resolved["references"].items())
        references.push_back(statusOfReference(key, reference, runDir / "references" / key));
    for (const Json& cell : resolved["cells"]) {
        const std::string name = cell["cell"];
        Json status = {{"cell", name}};
        status.update(statusOfTask(cell, runDir / "cells" / name));
        for (auto& [state, total] : totals.items())
            total = total.get<std::size_t>() +
                    (status[state].is_array() ? status[state].size() : status[state].get<std::size_t>());
        cells.push_back(std::move(status));
    }
    return {{"schema_version", 1},
            {"name", resolved["name"]},
            {"totals", totals},
            {"references", references},
            {"cells", cells}};
}

}  // namespace ulam
