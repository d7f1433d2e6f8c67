#pragma once
// What a run found: summary.json and its renderings, from the files of the run.

#include <filesystem>
#include <functional>

#include "experiments/engine/cell_errors.h"
#include "experiments/engine/run.h"
#include "experiments/statistics/curve.h"

namespace ulam {

/// A cell's finished replicates and what they amount to.
struct CellSummary {
    Json json;                              ///< its entry in summary.json
    CellErrors errors;
    std::vector<statistics::Curve> curves;  ///< per replicate: seconds and primary metric, snapshots and final image
};

CellSummary summarizeCell(const Plan& plan, const Cell& cell, const Reference& reference,
                          const std::filesystem::path& runDir);

/// Called before each cell with the share of cells that are done, by one thread at a time. What it throws ends the
/// summary.
using BeforeCell = std::function<void(double fraction, const std::string& cell)>;

/// The whole of summary.json, the same with any number of threads. Cells without a finished replicate, or whose
/// reference failed, are left out, with a warning. Each thread keeps the images of one cell in memory.
Json summarize(const Plan& plan, const std::filesystem::path& runDir, const std::vector<Failure>& failures,
               int threads = 1, const BeforeCell& beforeCell = {});

/// summary.json, summary.csv, comparisons.csv, summary.md and summary.tex.
void writeSummary(const std::filesystem::path& runDir, const Json& summary);

std::string summaryCsv(const Json& summary);
std::string comparisonsCsv(const Json& summary);
std::string summaryMarkdown(const Json& summary);
std::string summaryLatex(const Json& summary);

/// "relMSE" of "relmse"
std::string metricTitle(const std::string& metric);

}  // namespace ulam
