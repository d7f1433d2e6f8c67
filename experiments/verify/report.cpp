#include "experiments/verify/report.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/config/json_number.h"

namespace ulam::verify {

const char* name(Outcome outcome) {
    constexpr const char* names[] = {"passed", "rejected", "not audited", "reported", "not covered"};
    return names[int(outcome)];
}

bool SubjectReport::rejected() const {
    return std::any_of(findings.begin(), findings.end(), [](const Finding& f) {
        return f.outcome == Outcome::Rejected || f.outcome == Outcome::NotCovered;
    });
}

bool Report::rejected() const {
    return std::any_of(subjects.begin(), subjects.end(), [](const SubjectReport& s) { return s.rejected(); });
}

void print(const SubjectReport& report) {
    fmt::print("{} {}\n", report.kind, report.name);
    for (const Finding& f : report.findings) {
        fmt::print("  {:<3} {:<16} {:<12} {:>6.1f} s  {}\n", f.level, f.check, name(f.outcome), f.seconds, f.summary);
        for (const std::string& detail : f.details) fmt::print("      {}\n", detail);
    }
    if (report.rejected()) fmt::print("      repeat with: {}\n", report.replay);
}

Json toJson(const Report& report) {
    Json subjects = Json::array();
    for (const SubjectReport& s : report.subjects) {
        Json findings = Json::array();
        for (const Finding& f : s.findings)
            findings.push_back({{"level", f.level},
                                {"check", f.check},
                                {"outcome", name(f.outcome)},
                                {"summary", f.summary},
                                {"statistic", f.statistic ? numberOrText(*f.statistic) : Json()},
                                {"p", f.p ? Json(*f.p) : Json()},
                                {"samples", f.samples},
                                {"details", f.details},
                                {"numbers", f.numbers},
                                {"seconds", f.seconds}});
        subjects.push_back({{"kind", s.kind},
                            {"name", s.name},
                            {"rejected", s.rejected()},
                            {"replay", s.replay},
                            {"findings", findings}});
    }
    return {{"schema_version", 1},
            {"seed", report.seed},
            {"level", report.level},
            {"rejected", report.rejected()},
            {"subjects", subjects}};
}

}  // namespace ulam::verify
