#include "experiments/engine/summary.h"

#include <cmath>
#include <map>
#include <mutex>
#include <set>

#include "core/base/file.h"
#include "core/config/json_number.h"
#include "core/image/metrics.h"
#include "core/render/parallel.h"
#include "experiments/statistics/comparison.h"
#include "experiments/statistics/speedup.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

Json constantsOf(const std::vector<std::string>& names) {
    Json all = Json::object();
    for (const std::string& name : names) {
        const Metric& metric = findMetric(name);
        Json constants = Json::object();
        for (const MetricConstant& c : metric.constants) constants[std::string(c.name)] = c.value;
        all[name] = {{"definition", metric.definition},
                     {"constants", constants},
                     {"debiased", metric.debiased},
                     {"higher_is_better", metric.higherIsBetter}};
    }
    return all;
}

/// One sampler against the baseline: what is compared and what came out.
struct Judged {
    const CellSummary* cell;
    const CellSummary* baseline;
    ComparedReplicates replicates;
    statistics::Comparison comparison;
};

Json optionalNumber(const std::optional<double>& x) {
    return x ? Json(*x) : Json();
}

Json comparisonJson(const Judged& judged, const std::string& metric, const statistics::Design& design) {
    const statistics::Comparison& c = judged.comparison;
    std::vector<statistics::CurvePoint> ends;
    for (const auto& curve : pick(judged.cell->curves, judged.replicates.sampler)) ends.push_back(curve.back());
    const statistics::Speedup speedup =
        statistics::speedup(ends, pick(judged.baseline->curves, judged.replicates.baseline), design);
    return {{"scene", judged.cell->json["scene"]},
            {"sampler", judged.cell->json["sampler"]},
            {"baseline", judged.baseline->json["sampler"]},
            {"cell", judged.cell->json["cell"]},
            {"baseline_cell", judged.baseline->json["cell"]},
            {"metric", metric},
            {"ratio", optionalNumber(c.ratio)},
            {"ci95", intervalOrNull(c.ci95)},
            {"speedup", optionalNumber(speedup.value)},
            {"speedup_ci95", intervalOrNull(speedup.ci95)},
            {"p", c.p},
            {"p_adjusted", c.pAdjusted},
            {"paired", design.paired},
            {"looks", design.looks},
            {"detectable_ratio", optionalNumber(c.detectableRatio)},
            {"verdict", statistics::verdictName(c.verdict)},
            {"reference_too_poor", c.referenceTooPoor},
            {"heavy_tailed", c.heavyTailed}};
}

/// The values of a sweep that tell this cell from others, for a sentence.
std::string sweepText(const Json& sweep) {
    std::vector<std::string> parts;
    for (const auto& [path, value] : sweep.items()) parts.push_back(fmt::format("{} = {}", path, value.dump()));
    return parts.empty() ? "" : fmt::format(" ({})", fmt::join(parts, ", "));
}

std::string verdictSentence(const Judged& judged, const Json& comparison) {
    const statistics::Comparison& c = judged.comparison;
    const std::string start =
        fmt::format("{}: {}{}", comparison["scene"].get<std::string>(), comparison["sampler"].get<std::string>(),
                    sweepText(judged.cell->json["sweep"]));
    const std::string baseline = comparison["baseline"].get<std::string>(), verdict(statistics::verdictName(c.verdict));
    const std::string metric = metricTitle(comparison["metric"].get<std::string>());
    std::string reason;
    if (c.referenceTooPoor)
        reason = ", the reference is too poor";
    else if (!c.ci95)
        reason = ", too few replicates";
    else if (c.verdict == statistics::Verdict::Undecided && c.detectableRatio)
        reason = fmt::format(", differences below a factor of {:.2g} cannot be told at this scatter", 1 / *c.detectableRatio);
    if (!c.ratio) return fmt::format("{} against {} in {}: {}{}", start, baseline, metric, verdict, reason);
    const std::string range = c.ci95 ? fmt::format("95 % {:.3g}–{:.3g}, ", c.ci95->low, c.ci95->high) : "";
    return fmt::format("{} has {:.3g} times the {} of {} ({}p = {:.2g} adjusted): {}{}", start, *c.ratio, metric,
                       baseline, range, c.pAdjusted, verdict, reason);
}

class Summarizer {
public:
    Summarizer(const Plan& plan, const fs::path& runDir, int threads, const BeforeCell& beforeCell)
        : plan_(plan), runDir_(runDir), threads_(threads), beforeCell_(beforeCell) {}

    Json make(const std::vector<Failure>& failures) {
        summarizeCells(failures);
        Json summary = {{"schema_version", 1},
                        {"name", plan_.name},
                        {"primary_metric", plan_.metrics.front()},
                        {"metrics", constantsOf(plan_.metrics)}};
        compareAll(summary);
        for (const std::string& warning : sharedBiasWarnings(plan_)) warn("{}", warning);
        Json cells = Json::array();
        for (const CellSummary& cell : cells_) {
            if (cell.errors.errors.empty()) continue;
            cells.push_back(cell.json);
            for (const Json& warning : cell.json["warnings"])
                warn("{}: {}", cell.json["cell"].get<std::string>(), warning.get<std::string>());
        }
        summary["cells"] = std::move(cells);
        Json failed = Json::array();
        for (const Failure& f : failures) {
            failed.push_back({{"scene", f.scene},
                              {"cell", f.cell.empty() ? Json() : Json(f.cell)},
                              {"replicate", f.replicate ? Json(*f.replicate) : Json()},
                              {"message", f.message}});
            // People count from 1, as the progress does; the field counts as the folders do.
            warn("{}: {}",
                 f.cell.empty() ? fmt::format("the reference of {} failed", f.scene)
                 : f.replicate  ? fmt::format("{}: replicate {} failed", f.cell, *f.replicate + 1)
                                : fmt::format("{} failed", f.cell),
                 f.message);
        }
        summary["failures"] = std::move(failed);
        summary["warnings"] = warnings_;
        return summary;
    }

private:
    template <class... Arguments>
    void warn(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
        warnings_.push_back(fmt::format(format, std::forward<Arguments>(arguments)...));
    }

    void summarizeCells(const std::vector<Failure>& failures) {
        std::set<std::string> withoutReference;
        for (const Failure& f : failures)
            if (!f.replicate) withoutReference.insert(f.cell);
        std::vector<const Cell*> cells;
        std::map<std::size_t, Reference> references;
        for (const Cell& cell : plan_.cells) {
            if (withoutReference.contains(cell.task.name)) continue;
            cells.push_back(&cell);
            if (!references.contains(cell.reference))
                references.emplace(cell.reference, readReference(plan_.references[cell.reference], runDir_));
        }
        for (const auto& [index, reference] : references)
            if (!reference.biasLedger.empty())
                warn("{}: the reference is biased: {}", plan_.references[index].scene->name,
                     fmt::join(reference.biasLedger, "; "));
        cells_.resize(plan_.cells.size());  // comparisons find cells by their index
        std::mutex mutex;
        std::size_t begun = 0;
        forEachChunk(
            threads_, 0, cells.size(), 1, [](int) { return false; },
            [&](int, uint64_t number, uint64_t) {
                const Cell& cell = *cells[number];
                {
                    const std::lock_guard lock(mutex);
                    if (beforeCell_) beforeCell_(double(begun) / double(cells.size()), cell.task.name);
                    ++begun;
                }
                cells_[std::size_t(&cell - plan_.cells.data())] =
                    summarizeCell(plan_, cell, references.at(cell.reference), runDir_);
            });
        for (const Cell* cell : cells)
            if (cells_[std::size_t(cell - plan_.cells.data())].errors.errors.empty())
                warn("{}: no replicate finished", cell->task.name);
    }

    void compareAll(Json& summary) {
        std::vector<const CellErrors*> errors;
        for (const CellSummary& cell : cells_) errors.push_back(&cell.errors);
        Json comparisons = Json::array(), verdicts = Json::array();
        for (const DecidedComparison& decided : decideComparisons(plan_, errors)) {
            const Judged judged{&cells_[decided.planned.cell], &cells_[decided.planned.baseline], decided.replicates,
                                decided.result};
            comparisons.push_back(comparisonJson(judged, plan_.metrics.front(), plan_.design));
            verdicts.push_back(verdictSentence(judged, comparisons.back()));
            if (decided.result.heavyTailed)
                warn("{} against {}: the errors are heavy-tailed, so that the interval may cover less than 95 %",
                     judged.cell->json["cell"].get<std::string>(), judged.baseline->json["cell"].get<std::string>());
        }
        warnOfMixtures("machines", "results of unlike machines", "speed-ups, and errors under time budgets, are of the machines too",
                       [](const Json& machine) {
                           return fmt::format("{}, {} threads, {}", machine["processor"].get<std::string>(), machine["threads"].dump(),
                                              machine["simd"].dump());
                       });
        warnOfMixtures("builds", "results of different builds of the program or its plug-ins",
                       "what is compared may be two versions of an algorithm",
                       [](const Json& build) { return build["code_sha256"].get<std::string>().substr(0, 12); });
        summary["comparisons"] = std::move(comparisons);
        summary["verdicts"] = std::move(verdicts);
    }

    /// Of comparisons between whose replicates `field` of the cells differs.
    template <class Text>
    void warnOfMixtures(const char* field, const char* what, const char* consequence, Text text) {
        std::set<std::string> unlike;
        int mixed = 0;
        for (const PlannedComparison& c : plan_.comparisons) {
            if (cells_[c.cell].errors.errors.empty() || cells_[c.baseline].errors.errors.empty()) continue;
            std::set<std::string> own;
            for (const std::size_t cell : {c.cell, c.baseline})
                for (const Json& entry : cells_[cell].json[field]) own.insert(text(entry));
            if (own.size() < 2) continue;
            ++mixed;
            unlike.merge(own);
        }
        if (mixed > 0)
            warn("{} stand in {} of {} planned comparisons, so that {}: {}", what, mixed, plan_.comparisons.size(), consequence,
                 fmt::join(unlike, "; "));
    }

    const Plan& plan_;
    const fs::path& runDir_;
    int threads_;
    const BeforeCell& beforeCell_;
    std::vector<CellSummary> cells_;
    std::vector<std::string> warnings_;
};

}  // namespace

std::string metricTitle(const std::string& metric) {
    static const std::map<std::string, std::string> titles = {
        {"relmse", "relMSE"}, {"mse", "MSE"},   {"mae", "MAE"},   {"mape", "MAPE"},
        {"smape", "SMAPE"},   {"psnr", "PSNR"}, {"ssim", "SSIM"}, {"flip", "FLIP"}};
    const auto found = titles.find(metric);
    return found == titles.end() ? metric : found->second;
}

Json summarize(const Plan& plan, const fs::path& runDir, const std::vector<Failure>& failures, int threads,
               const BeforeCell& beforeCell) {
    return Summarizer(plan, runDir, threads, beforeCell).make(failures);
}

void writeSummary(const fs::path& runDir, const Json& summary) {
    writeFileAtomically(runDir / "summary.json", dump(summary) + "\n");
    writeFileAtomically(runDir / "summary.csv", summaryCsv(summary));
    writeFileAtomically(runDir / "comparisons.csv", comparisonsCsv(summary));
    writeFileAtomically(runDir / "summary.md", summaryMarkdown(summary));
    writeFileAtomically(runDir / "summary.tex", summaryLatex(summary));
}

}  // namespace ulam
