#include "experiments/verify/mutation_audit.h"

#include <chrono>

#include "core/mcmc/audit/balance.h"
#include "core/mcmc/audit/invariance.h"
#include "core/mcmc/audit/jacobian.h"
#include "core/mcmc/audit/rank.h"
#include "core/mcmc/audit/sequential.h"
#include "core/mcmc/audit/structure.h"
#include "core/render/parallel.h"

namespace ulam::verify {
namespace {

using namespace audit;

// Šidák's level of all L4 tests of a suite.
constexpr double kInvarianceLevel = 1e-6;
constexpr uint64_t kChunk = 500;

/// Shares trials out to threads; the tallies are merged in order, so that the threads do not matter.
template <class Tally, class Part>
Tally inParallel(int threads, uint64_t count, const Part& part) {
    std::vector<Tally> tallies(size_t((count + kChunk - 1) / kChunk));
    forEachChunk(
        threads, 0, count, kChunk, [](int) { return false; },
        [&](int, uint64_t begin, uint64_t end) { tallies[size_t(begin / kChunk)] = part(begin, end); });
    Tally sum;
    for (const Tally& tally : tallies) sum.merge(tally);
    return sum;
}

const char* nameOf(Space space) {
    return space == Space::Path ? "paths" : "numbers";
}

/// Somebody to mix with who reaches every state.
std::string ergodicPartner(const std::string& mutation, Space mutationSpace, Space target) {
    if (target == Space::Path && mutationSpace == Space::Path)
        return mutation == "bidirectional" ? "large_step" : "bidirectional";
    return mutation == "large_step" ? "kelemen_step" : "large_step";
}

class MutationAudit {
public:
    MutationAudit(const std::string& mutation, const AuditSettings& settings, References& references)
        : name_(mutation),
          settings_(settings),
          references_(references),
          key_(makeKey(settings.seed, cellOf(mutation))) {
        space_ = Registry<Mutation>::instance()
                     .find(mutation, JsonNode())
                     .create(JsonNode(Json{{"type", mutation}}))
                     ->space();
        targets_ = {Space::Path};
        if (space_ == Space::Primary) targets_.push_back(Space::Primary);
    }

    SubjectReport run() {
        report_ = {.kind = "mutation", .name = name_};
        timed([&] { findStates(); });
        if (report_.findings.back().outcome == Outcome::NotCovered) return report_;
        for (const auto check : {&MutationAudit::structure, &MutationAudit::balance, &MutationAudit::jacobian,
                                 &MutationAudit::invariance, &MutationAudit::images}) {
            timed([&] { (this->*check)(); });
            if (settings_.stopAtFirst && report_.rejected()) break;
        }
        return report_;
    }

private:
    /// A scene to which the mutation applies, with a target.
    struct Place {
        const AuditScene* scene;
        Space target;
        States states;
        std::string text;
    };

    template <class Action>
    void timed(const Action& action) {
        const auto start = std::chrono::steady_clock::now();
        action();
        report_.findings.back().seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    Finding& add(const char* level, const char* check) {
        report_.findings.push_back({.level = level, .check = check});
        return report_.findings.back();
    }
    void take(Finding& finding, const std::string& place, const Failures& failures) const {
        if (failures.count() == 0) return;
        finding.outcome = Outcome::Rejected;
        for (const Failure& f : failures.first())
            finding.details.push_back(fmt::format("{}, trial {}: {}", place, f.trial, f.message));
        if (failures.count() > failures.first().size())
            finding.details.push_back(fmt::format("{}: {} failures in all", place, failures.count()));
    }

    void findStates() {
        Finding& finding = add("", "states");
        std::string summary;
        for (const Space target : targets_)
            for (const auto& scene : auditScenes()) {
                const Subject subject(name_, target);
                Place place{scene.get(), target, drawStates(*scene, subject, key_, work_.seedSamples, work_.states),
                            fmt::format("{}, target over {}", scene->name, nameOf(target))};
                finding.numbers[place.text] = {{"drawn", place.states.drawn},
                                               {"with_light", place.states.positive},
                                               {"suitable", place.states.suitable}};
                if (target == targets_.front())
                    summary += fmt::format("{}{} of {} in {}", summary.empty() ? "applies to " : ", ",
                                           place.states.suitable, place.states.positive, scene->name);
                if (!place.states.x.empty()) places_.push_back(std::move(place));
            }
        finding.summary = summary;
        if (!places_.empty()) return;
        finding.outcome = Outcome::NotCovered;
        finding.details.push_back("the mutation suits no state of any audit scene: nothing was audited");
    }

    void structure() {
        Finding& finding = add("L0", "structure");
        StructureTally all;
        for (const Place& place : places_) {
            const Subject subject(name_, place.target, partnersOf(name_, place.target));
            const auto tally =
                inParallel<StructureTally>(settings_.threads, work_.structure, [&](uint64_t begin, uint64_t end) {
                    return auditStructure(*place.scene, subject, place.states, key_, begin, end);
                });
            take(finding, place.text, tally.failures);
            if (double(tally.notFinite) > kNotFiniteShare * double(tally.trials)) {
                finding.outcome = Outcome::Rejected;
                finding.details.push_back(fmt::format("{}: {} of {} acceptance ratios are not numbers", place.text,
                                                      tally.notFinite, tally.trials));
            }
            finding.numbers[place.text] = {{"trials", tally.trials},
                                           {"proposals", tally.proposals},
                                           {"failures", tally.failures.count()},
                                           {"not_finite", tally.notFinite}};
            all.merge(tally);
        }
        finding.summary =
            fmt::format("{} trials, {} proposals, {} not finite", all.trials, all.proposals, all.notFinite);
    }

    void balance() {
        Finding& finding = add("L1", "balance");
        BalanceTally all;
        for (const Place& place : places_) {
            const Subject subject(name_, place.target, partnersOf(name_, place.target));
            const auto tally =
                inParallel<BalanceTally>(settings_.threads, work_.balance, [&](uint64_t begin, uint64_t end) {
                    return auditBalance(*place.scene, subject, place.states, key_, begin, end);
                });
            take(finding, place.text, tally.failures);
            finding.numbers[place.text] = {{"steps", tally.steps},
                                           {"pairs", tally.pairs},
                                           {"worst_residual", finite(tally.worst)},
                                           {"worst_trial", tally.worstTrial}};
            all.merge(tally);
        }
        finding.summary =
            fmt::format("{} pairs, worst residual {:.2g} (trial {})", all.pairs, all.worst, all.worstTrial);
        if (finding.outcome == Outcome::Rejected) return;
        if (!all.hasDensity)
            notAudited(finding, "the mutation has no logDensity");
        else if (all.pairs == 0)
            notAudited(finding, "no step had a proposal");
    }

    void jacobian() {
        Finding& finding = add("L1", "jacobian");
        JacobianVerdict all;
        uint64_t proposals = 0, noisy = 0, notSquare = 0;
        for (const Place& place : places_) {
            if (place.target == Space::Primary) continue;
            const Subject subject(name_, place.target);
            const auto tally =
                inParallel<JacobianTally>(settings_.threads, work_.jacobian, [&](uint64_t begin, uint64_t end) {
                    return auditJacobian(*place.scene, subject, place.states, key_, begin, end);
                });
            const JacobianVerdict verdict = judge(tally);
            take(finding, place.text, verdict.failures);
            finding.numbers[place.text] = {{"proposals", tally.proposals},
                                           {"compared", verdict.comparisons},
                                           {"equalities", verdict.equalities},
                                           {"classes", verdict.classes},
                                           {"classes_too_small", verdict.unjudged},
                                           {"noisy", tally.noisy},
                                           {"more_numbers_than_coordinates", tally.notSquare},
                                           {"largest_median", verdict.worst}};
            proposals += tally.proposals, noisy += tally.noisy, notSquare += tally.notSquare;
            all.comparisons += verdict.comparisons, all.equalities += verdict.equalities,
                all.classes += verdict.classes;
            all.worst = std::max(all.worst, verdict.worst);
        }
        finding.summary = fmt::format(
            "{}{} of {} compared in {} classes, {} as equalities, {} noisy, {} not square; largest median {:.2g}",
            space_ == Space::Primary ? "map from numbers to paths: " : "", all.comparisons, proposals, all.classes,
            all.equalities, noisy, notSquare, all.worst);
        if (all.comparisons == 0) notAudited(finding, "no class of proposals could be compared");
    }

    void invariance() {
        Finding& finding = add("L4", "invariance");
        uint64_t starts = 0, steps = 0;
        size_t tests = 0;
        std::string worst;
        const double level = -std::expm1(std::log1p(-kInvarianceLevel) / double(settings_.subjects));
        const SequentialResult result = sequentialTest(level, [&](int round, double size) {
            const RandomKey key = makeKey(settings_.seed, cellOf(name_), uint64_t(round) + 1);
            double smallest = 1;
            tests = 0;
            const auto judgeTest = [&](double p, const std::string& what) {
                ++tests;
                if (p < smallest) smallest = p, worst = what;
            };
            for (const Place& place : places_)
                for (const bool mixed : {false, true}) {
                    const Subject subject(
                        name_, place.target,
                        mixed ? std::vector{ergodicPartner(name_, space_, place.target)} : std::vector<std::string>());
                    const TestFunctions functions(*place.scene, subject, key);
                    const auto count = uint64_t(double(work_.starts) * size / (place.target == Space::Primary ? 4 : 1));
                    const auto tally =
                        inParallel<InvarianceTally>(settings_.threads, count, [&](uint64_t begin, uint64_t end) {
                            return auditInvariance(*place.scene, subject, functions, key, begin, end);
                        });
                    starts += tally.starts, steps += tally.steps;
                    for (const IdentityTest& test : identityTests(functions, tally))
                        judgeTest(test.p, fmt::format("{}, {}: {} (z = {:.2f})", place.text, mixed ? "mixed" : "alone",
                                                      test.name, test.z));
                }
            if (space_ == Space::Primary) {
                const Subject subject(name_, Space::Primary);
                const auto ranks = inParallel<RankTally>(
                    settings_.threads, uint64_t(double(work_.ranks) * size), [&](uint64_t begin, uint64_t end) {
                        return auditRanks(*auditScenes().front(), subject, key, begin, end);
                    });
                judgeTest(rankTest(ranks), "ranks of exact starts on a toy target");
            }
            return -std::expm1(double(tests) * std::log1p(-smallest));  // Šidák
        });
        finding.summary = fmt::format("{} tests of {} steps from {} starts, p = {:.2g} in round {}", tests, steps,
                                      starts, result.p, result.rounds);
        finding.numbers = {{"tests", tests},          {"starts", starts}, {"steps", steps},         {"p", result.p},
                           {"rounds", result.rounds}, {"level", level},   {"most_deviating", worst}};
        if (!result.rejected) return;
        finding.outcome = Outcome::Rejected;
        finding.details.push_back(fmt::format("p = {:.3g}; most deviating: {}", result.p, worst));
    }

    void images() {
        std::vector<ImageComparison> comparisons;
        for (const Place& place : places_)
            for (const bool mixed : {false, true}) {
                const auto& scenes = mixed ? work_.mixedImages : work_.aloneImages;
                if (std::find(scenes.begin(), scenes.end(), place.scene->name) == scenes.end()) continue;
                const bool onPaths = place.target == Space::Path;
                Json config = samplerConfig(onPaths ? "mlt" : "pssmlt", *place.scene);
                // Many chains of a few steps: a lone mutation need not reach every state.
                const double mutations = onPaths ? work_.pathMutations : work_.primaryMutations;
                config["chains"] = std::llround(mutations / kStepsPerChain);
                config["bootstrap"] = std::llround(work_.bootstrap);
                config["mutations"] = {{name_, {{"weight", 1}}}};
                if (mixed) config["mutations"][ergodicPartner(name_, space_, place.target)] = {{"weight", 0.37}};
                Budget budget;
                budget.mutations = mutations;
                const std::string text = fmt::format("{} by {}, {}", place.scene->name, onPaths ? "mlt" : "pssmlt",
                                                     mixed ? "mixed" : "alone");
                const TiledEstimate runs = renderTiled(place.scene->scene, config, budget, work_.runs, settings_.seed,
                                                       cellOf(name_ + text), settings_.threads);
                comparisons.push_back(compare(text, runs, references_(*place.scene)));
            }
        report_.findings.push_back(judgeImages(comparisons, work_));
    }

    static constexpr double kStepsPerChain = 64;
    static Json finite(double x) { return std::isfinite(x) ? Json(x) : Json(fmt::format("{}", x)); }
    static void notAudited(Finding& finding, const char* why) {
        finding.outcome = Outcome::NotAudited;
        finding.summary = why;
    }

    std::string name_;
    AuditSettings settings_;
    const Work& work_ = settings_.work;
    References& references_;
    RandomKey key_;
    Space space_;
    std::vector<Space> targets_;
    std::vector<Place> places_;
    SubjectReport report_;
};

}  // namespace

SubjectReport auditMutation(const std::string& mutation, const AuditSettings& settings, References& references) {
    return MutationAudit(mutation, settings, references).run();
}

}  // namespace ulam::verify
