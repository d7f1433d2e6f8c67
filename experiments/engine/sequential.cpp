#include "experiments/engine/sequential.h"

#include <algorithm>
#include <map>

#include "experiments/statistics/moments.h"

namespace ulam {
namespace {

/// Of runs that failed nothing is known and nothing more is asked.
bool isKnown(const std::optional<statistics::Interval>& interval, double value, double relativeWidth) {
    return !interval || (interval->high - interval->low) / 2 <= relativeWidth * value;
}

std::vector<CellErrors> allErrors(const Plan& plan, const std::filesystem::path& runDir,
                                  const std::set<std::size_t>& without) {
    std::map<std::size_t, Reference> references;
    std::vector<CellErrors> errors;
    for (const Cell& cell : plan.cells) {
        if (without.contains(cell.reference)) {
            errors.emplace_back();
            continue;
        }
        auto known = references.find(cell.reference);
        if (known == references.end())
            known = references.emplace(cell.reference, readReference(plan.references[cell.reference], runDir)).first;
        errors.push_back(cellErrors(plan, cell, known->second, runDir));
    }
    return errors;
}

std::set<std::size_t> openCells(const Plan& plan, const std::vector<CellErrors>& errors) {
    const double width = plan.until->relativeCi;
    std::vector<const CellErrors*> cells;
    for (const CellErrors& cell : errors) cells.push_back(&cell);
    std::set<std::size_t> open, compared;
    for (const PlannedComparison& c : plan.comparisons) compared.insert({c.cell, c.baseline});
    for (const DecidedComparison& c : decideComparisons(plan, cells)) {
        if (c.result.referenceTooPoor || c.result.verdict != statistics::Verdict::Undecided) continue;
        if (!isKnown(c.result.ci95, c.result.ratio.value_or(0), width))
            open.insert({c.planned.cell, c.planned.baseline});
    }
    for (std::size_t c = 0; c < errors.size(); ++c) {
        if (compared.contains(c) || !errors[c].halvesAgree) continue;
        const auto mean = statistics::meanInterval(errors[c].errors, plan.design.confidence());
        if (!mean || mean->method == statistics::IntervalMethod::LinearT) continue;
        if (!isKnown(mean->interval, statistics::mean(errors[c].errors), width)) open.insert(c);
    }
    return open;
}

}  // namespace

int addReplicates(Plan& plan, const std::filesystem::path& runDir, const std::set<std::size_t>& without) {
    const std::vector<int> counts = plan.replicatesOfCells();
    const int reached = std::ranges::max(counts), next = std::min(2 * reached, plan.until->maxReplicates);
    if (next <= reached) return 0;  // this was the last look
    int added = 0;
    for (const std::size_t c : openCells(plan, allErrors(plan, runDir, without))) {
        int& replicates = plan.cells[c].task.replicates;
        added += next - replicates;
        replicates = next;
    }
    return added;
}

std::vector<Plan::Replicate> nextLook(Plan& plan, const std::filesystem::path& runDir,
                                      const std::set<std::size_t>& without, Progress& progress) {
    if (!plan.until) return {};
    const std::vector<int> done = plan.replicatesOfCells();
    if (const int added = addReplicates(plan, runDir, without); added > 0)
        progress.message(fmt::format("not decided yet: {} replicates more", added));
    return plan.order(done);
}

}  // namespace ulam
