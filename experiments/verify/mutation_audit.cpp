#include "experiments/verify/mutation_audit.h"

#include <chrono>

#include "experiments/verify/mutation_levels.h"

namespace ulam::verify {

MutationCase::MutationCase(const std::string& mutation, const AuditSettings& auditSettings)
    : name(mutation), settings(auditSettings), key(makeKey(settings.seed, cellOf(mutation))), targets{Space::Path} {
    space = Registry<Mutation>::instance()
                .find(mutation, JsonNode())
                .create(JsonNode(Json{{"type", mutation}}))
                ->space();
    if (space == Space::Primary) targets.push_back(Space::Primary);
}

SubjectReport auditMutation(const std::string& mutation, const AuditSettings& settings, References& references) {
    MutationCase c(mutation, settings);
    SubjectReport report{.kind = "mutation", .name = mutation};
    const auto level = [&](const auto& audit) {
        if (settings.stopAtFirst && report.rejected()) return;
        const auto start = std::chrono::steady_clock::now();
        report.findings.push_back(audit());
        report.findings.back().seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    level([&] { return findStates(c); });
    if (c.places.empty()) return report;
    level([&] { return auditStructure(c); });
    level([&] { return auditBalance(c); });
    level([&] { return auditJacobian(c); });
    level([&] { return auditDensities(c); });
    level([&] { return auditInvariance(c); });
    level([&] { return auditImages(c, references); });
    level([&] { return auditMixedInvariance(c); });
    level([&] { return auditMixedImages(c, references); });
    level([&] { return reportMixing(c, references); });
    return report;
}

}  // namespace ulam::verify
