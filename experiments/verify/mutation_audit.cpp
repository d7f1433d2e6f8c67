#include "experiments/verify/mutation_audit.h"

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
    double done = 0;
    // `share` of the time, about: of mutations of either space and at either level.
    const auto level = [&](const char* what, double share, const auto& check) {
        if (settings.stopAtFirst && report.rejected()) return;
        settings.progress(done, what);
        report.findings.push_back(timed(check));
        done += share;
    };
    level("states", 0.01, [&] { return findStates(c); });
    if (c.places.empty()) return report;
    level("structure", 0.05, [&] { return auditStructure(c); });
    level("balance", 0.02, [&] { return auditBalance(c); });
    level("jacobian", 0.02, [&] { return auditJacobian(c); });
    level("density", 0.1, [&] { return auditDensities(c); });
    level("invariance", 0.15, [&] { return auditInvariance(c); });
    level("images", 0.25, [&] { return auditImages(c, references); });
    level("mixed invariance", 0.15, [&] { return auditMixedInvariance(c); });
    level("mixed images", 0.2, [&] { return auditMixedImages(c, references); });
    level("mixing", 0.05, [&] { return reportMixing(c, references); });
    return report;
}

}  // namespace ulam::verify
