#include "experiments/report/cell_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "experiments/engine/run_folder.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

/// The replicate the summary names, or else the one of this rank (0 … 1) in the primary metric, or else the first.
std::size_t chooseReplicate(const Json& cell, const char* name, double rank, const std::string& metric) {
    if (const auto named = cell.find(name); named != cell.end() && named->is_number_integer())
        return named->get<std::size_t>();
    const Json values = cell.value(Json::json_pointer("/metrics/" + metric + "/values"), Json::array());
    const Json numbers = cell.value("replicate_numbers", Json::array());
    std::vector<std::pair<double, std::size_t>> sorted;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i].is_number())
            sorted.emplace_back(values[i].get<double>(), i < numbers.size() ? numbers[i].get<std::size_t>() : i);
    if (sorted.empty()) return 0;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(rank * double(sorted.size() - 1))].second;
}

std::vector<std::pair<int, int>> techniquesIn(const fs::path& replicate) {
    std::vector<std::pair<int, int>> found;
    if (!fs::exists(replicate / "extra")) return found;
    for (const fs::directory_entry& entry : fs::directory_iterator(replicate / "extra")) {
        const std::string name = entry.path().filename().string();
        if (name.size() < 7 || name[0] != 's' || !name.ends_with("_weighted.exr")) continue;
        int s = 0, t = 0;
        const char* const end = name.data() + name.size();
        const auto read = std::from_chars(name.data() + 1, end, s);
        if (read.ec != std::errc() || end - read.ptr < 3 || std::from_chars(read.ptr + 2, end, t).ec != std::errc())
            continue;
        if (fs::exists(techniqueFile(replicate, {s, t}, "unweighted"))) found.emplace_back(s, t);
    }
    std::ranges::sort(found);
    return found;
}

}  // namespace

Json readJsonIfThere(const fs::path& path) {
    return fs::exists(path) ? readOwnJson(path) : Json();
}

std::map<std::size_t, fs::path> replicateFolders(const fs::path& cellFolder) {
    std::map<std::size_t, fs::path> folders;
    if (!fs::exists(cellFolder)) return folders;
    for (const fs::directory_entry& entry : fs::directory_iterator(cellFolder)) {
        const std::string name = entry.path().filename().string();
        std::size_t replicate = 0;
        const char* const end = name.data() + name.size();
        const bool numbered = name.starts_with('r') && std::from_chars(name.data() + 1, end, replicate).ptr == end;
        if (numbered && fs::exists(entry.path() / "image.exr")) folders.emplace(replicate, entry.path());
    }
    return folders;
}

fs::path techniqueFile(const fs::path& replicate, std::pair<int, int> technique, std::string_view kind) {
    return replicate / "extra" / fmt::format("s{:02}_t{:02}_{}.exr", technique.first, technique.second, kind);
}

CellPlan planCell(const fs::path& runDir, const Json& cell, const std::string& metric) {
    CellPlan plan;
    plan.cell = cell.at("cell").get<std::string>();
    plan.replicates = replicateFolders(runDir / "cells" / plan.cell);
    const auto there = [&](std::size_t replicate) {
        return plan.replicates.empty() || plan.replicates.contains(replicate) ? replicate
                                                                              : plan.replicates.begin()->first;
    };
    plan.median = there(chooseReplicate(cell, "median_replicate", 0.5, metric));
    plan.worst = there(chooseReplicate(cell, "worst_replicate", 1, metric));
    const std::string reference = cell.value("reference_image", std::string());
    if (!reference.empty() && fs::exists(runDir / reference)) plan.reference = runDir / reference;
    if (plan.replicates.empty()) return plan;
    plan.techniques = techniquesIn(plan.folder());
    plan.result = readJsonIfThere(plan.folder() / "result.json");
    return plan;
}

}  // namespace ulam
