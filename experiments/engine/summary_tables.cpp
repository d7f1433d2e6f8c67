// The summary as tables: one row a cell and metric, and one a comparison (CSV), one a cell (Markdown, LaTeX).

#include <algorithm>
#include <map>
#include <regex>

#include "experiments/engine/summary.h"
#include "experiments/engine/sweep.h"

namespace ulam {
namespace {

std::string text(const Json& value, const char* format = "{:.4g}") {
    if (value.is_number_float()) return fmt::format(fmt::runtime(format), value.get<double>());
    if (value.is_string()) return value.get<std::string>();
    return value.is_null() ? "" : value.dump();
}

std::string csvField(const Json& value) {
    const std::string plain = text(value, "{}");
    if (plain.find_first_of(",\"\r\n") == plain.npos) return plain;
    std::string quoted = "\"";
    for (const char c : plain) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string csvRow(const std::vector<Json>& values) {
    std::vector<std::string> fields;
    for (const Json& value : values) fields.push_back(csvField(value));
    return fmt::format("{}\n", fmt::join(fields, ","));
}

/// The first or second end of what may be an interval.
Json endOf(const Json& interval, std::size_t end) {
    return interval.is_array() ? interval[end] : Json();
}

/// Of all cells, in the order in which they come up.
std::vector<std::string> sweptPaths(const Json& summary) {
    std::vector<std::string> paths;
    for (const Json& cell : summary["cells"])
        for (const auto& [path, value] : cell["sweep"].items())
            if (std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
    return paths;
}

/// The names of columns, those of swept values at the end.
std::string csvHeader(std::vector<Json> names, const std::vector<std::string>& paths) {
    for (const std::string& path : paths) names.push_back("sweep." + path);
    return csvRow(names);
}

void addSwept(std::vector<Json>& row, const Json& cell, const std::vector<std::string>& paths) {
    for (const std::string& path : paths) row.push_back(cell["sweep"].value(path, Json()));
}

std::string intervalText(const Json& interval, const char* to) {
    if (!interval.is_array()) return "";
    return text(interval[0], "{:.3g}") + to + (interval[1].is_null() ? "∞" : text(interval[1], "{:.3g}"));
}

std::string latexText(const std::string& plain) {
    std::string safe;
    for (const char c : plain) {
        switch (c) {
            case '\\':
                safe += "\\textbackslash{}";
                break;
            case '^':
                safe += "\\textasciicircum{}";
                break;
            case '~':
                safe += "\\textasciitilde{}";
                break;
            default:
                if (std::string_view("_&%$#{}").find(c) != std::string_view::npos) safe += '\\';
                safe += c;
        }
    }
    return safe;
}

/// 1.2e-05 as a power of ten, and ∞.
std::string latexNumbers(const std::string& plain) {
    static const std::regex exponent("([0-9.]+)e([+-]?)[+0]*([0-9]+)"), infinity("∞");
    std::string set = std::regex_replace(plain, exponent, "$$$1\\cdot10^{$2$3}$$");
    for (auto at = set.find("{+"); at != set.npos; at = set.find("{+")) set.erase(at + 1, 1);
    return std::regex_replace(set, infinity, "$$\\infty$$");
}

/// "2.31 (1.9–2.8)" of the comparison in which a cell is judged; empty for baselines.
struct CellVerdict {
    std::string ratio, speedup, p, verdict;
};
CellVerdict verdictOf(const Json& summary, const Json& cell, const char* to) {
    for (const Json& c : summary["comparisons"]) {
        if (c["cell"] != cell["cell"]) continue;
        const auto withInterval = [&](const char* value, const char* range) {
            if (c[value].is_null()) return std::string();
            return c[range].is_null() ? text(c[value], "{:.3g}")
                                      : fmt::format("{} ({})", text(c[value], "{:.3g}"), intervalText(c[range], to));
        };
        return {withInterval("ratio", "ci95"), withInterval("speedup", "speedup_ci95"), text(c["p_adjusted"], "{:.2g}"),
                text(c["verdict"])};
    }
    return {};
}

}  // namespace

std::string summaryCsv(const Json& summary) {
    const std::vector<std::string> paths = sweptPaths(summary);
    std::string csv = csvHeader({"cell", "scene", "sampler", "replicates", "metric", "mean", "ci95_low", "ci95_high", "trimmed_mean",
                                 "worst_replicate", "variance", "bias_squared", "seconds", "rays", "mutations", "normalization_cv"},
                                paths);
    for (const Json& cell : summary["cells"]) {
        for (const auto& [name, metric] : cell["metrics"].items()) {
            std::vector<Json> row{cell["cell"], cell["scene"], cell["sampler"], cell["replicates"], name, metric["mean"],
                                  endOf(metric["ci95"], 0), endOf(metric["ci95"], 1), metric["trimmed_mean"],
                                  metric["worst_replicate"], cell["variance"], cell["bias_squared"], cell["seconds"], cell["rays"],
                                  cell["mutations"], cell["normalization_cv"]};
            addSwept(row, cell, paths);
            csv += csvRow(row);
        }
    }
    return csv;
}

std::string comparisonsCsv(const Json& summary) {
    const std::vector<std::string> paths = sweptPaths(summary);
    std::map<std::string, const Json*> cells;
    for (const Json& cell : summary["cells"]) cells[cell["cell"].get<std::string>()] = &cell;
    std::string csv = csvHeader({"cell", "baseline_cell", "scene", "sampler", "baseline", "metric", "ratio", "ci95_low", "ci95_high",
                                 "speedup", "speedup_ci95_low", "speedup_ci95_high", "p", "p_adjusted", "verdict",
                                 "detectable_ratio", "reference_too_poor", "heavy_tailed"},
                                paths);
    for (const Json& c : summary["comparisons"]) {
        std::vector<Json> row{c["cell"], c["baseline_cell"], c["scene"], c["sampler"], c["baseline"], c["metric"], c["ratio"],
                              endOf(c["ci95"], 0), endOf(c["ci95"], 1), c["speedup"], endOf(c["speedup_ci95"], 0),
                              endOf(c["speedup_ci95"], 1), c["p"], c["p_adjusted"], c["verdict"], c["detectable_ratio"],
                              c["reference_too_poor"], c["heavy_tailed"]};
        addSwept(row, *cells.at(c["cell"].get<std::string>()), paths);
        csv += csvRow(row);
    }
    return csv;
}

std::string summaryMarkdown(const Json& summary) {
    std::string md = fmt::format("# {}\n\n", summary["name"].get<std::string>());
    for (const Json& verdict : summary["verdicts"]) md += fmt::format("- {}\n", verdict.get<std::string>());
    std::vector<std::string> metrics;
    for (const auto& [name, definition] : summary["metrics"].items()) metrics.push_back(name);
    md += "\n| cell | replicates |";
    for (const std::string& name : metrics) md += fmt::format(" {} (95 %) |", metricTitle(name));
    md += " seconds | rays | ratio (95 %) | speed-up (95 %) | p adjusted | verdict |\n|---|--:|";
    for (std::size_t i = 0; i < metrics.size(); ++i) md += "--:|";
    md += "--:|--:|--:|--:|--:|---|\n";
    for (const Json& cell : summary["cells"]) {
        md += fmt::format("| {} | {} |", text(cell["cell"]), text(cell["replicates"]));
        for (const std::string& name : metrics) {
            const Json& metric = cell["metrics"][name];
            const std::string range = intervalText(metric["ci95"], "–");
            md += fmt::format(" {}{} |", text(metric["mean"]), range.empty() ? "" : " (" + range + ")");
        }
        const CellVerdict v = verdictOf(summary, cell, "–");
        md += fmt::format(" {} | {} | {} | {} | {} | {} |\n", text(cell["seconds"], "{:.3g}"),
                          text(cell["rays"], "{:.3g}"), v.ratio, v.speedup, v.p, v.verdict);
    }
    if (!summary["warnings"].empty()) md += "\n## Warnings\n\n";
    for (const Json& warning : summary["warnings"]) md += fmt::format("- {}\n", warning.get<std::string>());
    return md;
}

std::string summaryLatex(const Json& summary) {
    const std::string metric = summary["primary_metric"].get<std::string>();
    const std::vector<std::string> paths = sweptPaths(summary);
    std::string tex = fmt::format(
        "% needs the package booktabs\n\\begin{{tabular}}{{llrrrrl}}\n\\toprule\nscene & sampler & {} & 95\\,\\% & "
        "ratio & $p$ & verdict \\\\\n\\midrule\n",
        metricTitle(metric));
    for (const Json& cell : summary["cells"]) {
        const CellVerdict v = verdictOf(summary, cell, "--");
        std::string sampler = text(cell["sampler"]);
        for (const auto& [path, value] : cell["sweep"].items())
            sampler += fmt::format(", {} {}", shortName(path, paths), text(value));
        const Json& error = cell["metrics"][metric];
        tex +=
            fmt::format("{} & {} & {} & {} & {} & {} & {} \\\\\n", latexText(text(cell["scene"])), latexText(sampler),
                        latexNumbers(text(error["mean"])), latexNumbers(intervalText(error["ci95"], "--")),
                        latexNumbers(v.ratio), latexNumbers(v.p), v.verdict);
    }
    return tex + "\\bottomrule\n\\end{tabular}\n";
}

}  // namespace ulam
