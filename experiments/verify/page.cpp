#include "experiments/verify/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/report/page.h"

namespace ulam::verify {
namespace {

// Beside the style of reports, whose colours it uses.
constexpr const char* kStyle = R"(
table { border-collapse: collapse; width: 100%; margin-top: 6px; }
th, td { text-align: left; padding: 3px 12px 3px 0; vertical-align: top; border-bottom: 1px solid var(--rule); }
th { color: var(--muted); font-weight: 400; font-size: 12px; }
th:not(.number) { text-align: left; } td { white-space: normal; } td.number { text-align: right; white-space: nowrap; }
th.number { text-align: right; } td:last-child:not(.short) { min-width: 24rem; } td.short { white-space: nowrap; }
.passed { color: var(--better); } .rejected, .not-covered { color: var(--alarm); font-weight: 600; }
.not-audited { color: var(--worse); } .reported { color: var(--muted); }
.pictures { display: flex; flex-wrap: wrap; gap: 14px 22px; margin-top: 8px; }
figure { max-width: 250px; }
figcaption { font-size: 11.5px; color: var(--muted); line-height: 1.35; overflow-wrap: anywhere; }
svg { display: block; }
svg .bar { fill: var(--neutral-bar); } svg .axis { stroke: var(--rule); fill: none; }
svg .expected { stroke: var(--link); fill: none; stroke-width: 1.6; } svg .band { fill: var(--link); opacity: 0.22; }
svg .dots { fill: var(--link); } svg text { fill: var(--muted); font-size: 10px; }
svg .tile { fill: var(--diverging-high); } svg .ground { fill: var(--raised); stroke: var(--rule); }
)";

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '>') out += "&gt;";
        else if (c == '"') out += "&quot;";
        else out += c;
    }
    return out;
}

std::string outcomeOf(const Finding& f) {
    std::string style = name(f.outcome);
    std::replace(style.begin(), style.end(), ' ', '-');
    return fmt::format("<span class=\"{}\">{}</span>", style, name(f.outcome));
}

std::string number(const std::optional<double>& x) {
    return x ? fmt::format("{:.3g}", *x) : "";
}

std::string figure(const std::string& svg, int width, int height, const std::string& caption) {
    return fmt::format("<figure><svg width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\">{2}</svg>"
                       "<figcaption>{3}</figcaption></figure>\n",
                       width, height, svg, escaped(caption));
}

/// Bars: proposals, by share over width. Line and band: what the density says, with two standard errors.
std::string histogram(const Json& test, const Json& m) {
    constexpr double width = 240, height = 110, floor = 96;
    const auto edges = m["edges"].get<std::vector<double>>();
    const auto observed = m["observed"].get<std::vector<double>>(), expected = m["expected"].get<std::vector<double>>(),
               error = m["standard_error"].get<std::vector<double>>();
    double most = 0;
    const auto per = [&](size_t i, double share) { return share / (edges[i + 1] - edges[i]); };
    for (size_t i = 0; i < observed.size(); ++i) most = std::max({most, per(i, observed[i]), per(i, expected[i] + 2 * error[i])});
    const auto x = [&](double v) { return width * (v - edges.front()) / (edges.back() - edges.front()); };
    const auto y = [&](double v) { return floor - (floor - 4) * v / most; };
    std::string bars, band, line;
    for (size_t i = 0; i < observed.size(); ++i) {
        const double a = x(edges[i]), b = x(edges[i + 1]), top = y(per(i, observed[i]));
        bars += fmt::format("<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", a, top,
                            std::max(0.5, b - a - 0.6), floor - top);
        const double high = y(per(i, expected[i] + 2 * error[i])), low = y(per(i, std::max(0.0, expected[i] - 2 * error[i])));
        band += fmt::format("<rect class=\"band\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", a, high, b - a, low - high);
        line += fmt::format("{}{:.1f} {:.1f}L{:.1f} {:.1f}", i == 0 ? "M" : "L", a, y(per(i, expected[i])), b, y(per(i, expected[i])));
    }
    const std::string axis = fmt::format("<path class=\"axis\" d=\"M0 {0}H{1}\"/><text x=\"0\" y=\"{2}\">{3:.3g}</text>"
                                         "<text x=\"{1}\" y=\"{2}\" text-anchor=\"end\">{4:.3g}</text>",
                                         floor, width, height - 3, edges.front(), edges.back());
    return figure(fmt::format("{}{}<path class=\"expected\" d=\"{}\"/>{}", bars, band, line, axis), int(width), int(height),
                  fmt::format("{}: {}, state {}, {}; p = {:.2g}", m["name"].get<std::string>(), test["place"].get<std::string>(),
                              test["state"].get<uint64_t>(), test["class"].get<std::string>(), m["p"].get<double>()));
}

/// Of each test: the most deviating histograms.
std::string densityPictures(const Finding& f) {
    constexpr size_t kMost = 4;
    std::string out;
    if (!f.numbers.contains("histograms")) return out;
    for (const Json& test : f.numbers["histograms"]) {
        std::vector<const Json*> marginals;
        for (const Json& m : test["marginals"])
            if (m["observed"].size() > 1) marginals.push_back(&m);
        std::stable_sort(marginals.begin(), marginals.end(),
                         [](const Json* a, const Json* b) { return (*a)["p"].get<double>() < (*b)["p"].get<double>(); });
        for (size_t i = 0; i < std::min(kMost, marginals.size()); ++i) out += histogram(test, *marginals[i]);
    }
    if (out.empty()) return out;
    return "<h3>Proposals and their density (L2)</h3><p class=\"note\">Bars: proposals of the mutation from one state. Line: the integral of "
           "exp(logDensity) over each bin, band: two standard errors of that estimate. Of each scene the class of proposals with the "
           "smallest p, and of it the histograms that deviate most.</p><div class=\"pictures\">" + out + "</div>\n";
}

/// Sorted p-values against those of uniform ones; where all is right they follow the diagonal.
std::string uniformity(std::vector<double> p, const std::string& caption) {
    constexpr double size = 150;
    std::sort(p.begin(), p.end());
    std::string dots = fmt::format("<rect class=\"ground\" x=\"0.5\" y=\"0.5\" width=\"{0}\" height=\"{0}\"/>"
                                   "<path class=\"axis\" d=\"M0 {1}L{1} 0\"/>", size - 1, size);
    for (size_t i = 0; i < p.size(); ++i)
        dots += fmt::format("<circle class=\"dots\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.7\"/>", size * (double(i) + 0.5) / double(p.size()), size * (1 - p[i]));
    return figure(dots, int(size), int(size), caption);
}

/// Tiles in their places, the stronger the smaller p is.
std::string tileMap(const std::vector<double>& p, size_t across, const std::string& caption) {
    const double size = 150.0 / double(across), channels = 3;
    const size_t tiles = p.size() / size_t(channels), down = (tiles + across - 1) / across;
    std::string squares = fmt::format("<rect class=\"ground\" x=\"0\" y=\"0\" width=\"{}\" height=\"{}\"/>", size * double(across), size * double(down));
    for (size_t t = 0; t < tiles; ++t) {
        const size_t column = t % across, row = t / across;
        const double least = std::max(1e-12, *std::min_element(p.begin() + std::ptrdiff_t(3 * t), p.begin() + std::ptrdiff_t(3 * t + 3)));
        squares += fmt::format("<rect class=\"tile\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" opacity=\"{:.2f}\"><title>p = {:.3g}</title></rect>",
                               size * double(column), size * double(row), size - 1, size - 1, std::min(1.0, -std::log10(least) / 8), least);
    }
    return figure(squares, 150, int(size * double(down)), caption);
}

std::string imagePictures(const Finding& f) {
    std::string out;
    for (const auto& [place, numbers] : f.numbers.items()) {
        if (!numbers.is_object() || !numbers.contains("p_values")) continue;
        const auto p = numbers["p_values"].get<std::vector<double>>();
        out += uniformity(p, fmt::format("{}: sorted p-values of {} tests", place, p.size()));
        out += tileMap(p, numbers["tiles_across"].get<size_t>(),
                       fmt::format("{}: smallest p of each tile; adjusted {:.2g}", place, numbers["smallest_adjusted_p"].get<double>()));
    }
    if (out.empty()) return out;
    return fmt::format("<h3>Tiles of the images ({})</h3><p class=\"note\">Dots on the diagonal: p-values as they are where both images "
                       "have the same mean. Tiles: full colour is p = 1e-8.</p><div class=\"pictures\">{}</div>\n", f.level, out);
}

std::string section(const SubjectReport& s) {
    std::string rows, pictures, details;
    for (const Finding& f : s.findings) {
        rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>"
                            "<td class=\"number\">{:.1f}</td><td>{}</td></tr>\n",
                            f.level, escaped(f.check), outcomeOf(f), number(f.statistic), number(f.p), f.samples, f.seconds, escaped(f.summary));
        for (const std::string& d : f.details) details += fmt::format("<li>{} {}: {}</li>", f.level, escaped(f.check), escaped(d));
        pictures += densityPictures(f) + imagePictures(f);
    }
    return fmt::format("<section id=\"{0}-{1}\"><h2>{0} {1}</h2><p class=\"note\">{2}</p>{3}<div class=\"scroll\"><table><thead><tr><th>level</th><th>check</th>"
                       "<th>outcome</th><th class=\"number\">statistic</th><th class=\"number\">p</th><th class=\"number\">samples</th><th class=\"number\">seconds</th><th></th></tr></thead><tbody>\n{4}</tbody></table></div>\n{5}</section>\n",
                       s.kind, escaped(s.name), escaped(s.replay), details.empty() ? "" : fmt::format("<div class=\"{}\"><ul>{}</ul></div>", s.rejected() ? "alarm" : "note", details),
                       rows, pictures);
}

/// One row a subject, one column a check.
std::string overview(const Report& report) {
    std::vector<std::string> columns;
    for (const SubjectReport& s : report.subjects)
        for (const Finding& f : s.findings) {
            const std::string column = fmt::format("{} {}", f.level, f.check);
            if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
        }
    std::stable_sort(columns.begin(), columns.end());
    std::string head = "<th></th>", rows;
    for (const std::string& column : columns) head += fmt::format("<th>{}</th>", escaped(column));
    for (const SubjectReport& s : report.subjects) {
        rows += fmt::format("<tr><td><a href=\"#{0}-{1}\">{0} {1}</a></td>", s.kind, escaped(s.name));
        for (const std::string& column : columns) {
            const auto f = std::find_if(s.findings.begin(), s.findings.end(), [&](const Finding& x) { return fmt::format("{} {}", x.level, x.check) == column; });
            rows += fmt::format("<td class=\"short\">{}</td>", f == s.findings.end() ? "" : outcomeOf(*f));
        }
        rows += "</tr>\n";
    }
    return fmt::format("<section><div class=\"scroll\"><table><thead><tr>{}</tr></thead><tbody>{}</tbody></table></div></section>\n", head, rows);
}

}  // namespace

std::string toHtml(const Report& report) {
    const auto rejected = std::count_if(report.subjects.begin(), report.subjects.end(), [](const SubjectReport& s) { return s.rejected(); });
    std::string body;
    for (const SubjectReport& s : report.subjects) body += section(s);
    return fmt::format("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
                       "<title>Audit</title><style>{}{}</style></head>\n<body><header><p class=\"kind\">Ulam</p><h1>Audit: {}</h1>"
                       "<p class=\"subtitle\">{} subject{}, level {}, seed {}</p></header>\n{}{}</body></html>\n",
                       page::kStyle, kStyle, rejected == 0 ? "nothing is rejected" : fmt::format("{} of {} rejected", rejected, report.subjects.size()),
                       report.subjects.size(), report.subjects.size() == 1 ? "" : "s", report.level, report.seed, overview(report), body);
}

}  // namespace ulam::verify
