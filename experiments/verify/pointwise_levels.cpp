// Levels that look at single proposals.

#include "core/config/json_number.h"
#include "core/mcmc/audit/balance.h"
#include "core/mcmc/audit/density.h"
#include "core/mcmc/audit/jacobian.h"
#include "core/mcmc/audit/structure.h"
#include "experiments/statistics/holm.h"
#include "experiments/verify/mutation_levels.h"
#include "experiments/verify/trial_token.h"

namespace ulam::verify {
namespace {

using namespace audit;

const char* nameOf(Space space) {
    return space == Space::Path ? "paths" : "numbers";
}
void notAudited(Finding& finding, const char* why) {
    finding.outcome = Outcome::NotAudited;
    finding.summary = why;
}

void take(Finding& finding, const MutationCase& c, const Place& place, const Failures& failures) {
    if (failures.count() == 0) return;
    finding.outcome = Outcome::Rejected;
    for (const Failure& f : failures.first())
        finding.details.push_back(fmt::format("{}: {}; ulam replay-path {}", place.text, f.message, trialToken(c, place, finding.check, f.trial)));
    if (failures.count() > failures.first().size())
        finding.details.push_back(fmt::format("{}: {} failures in all", place.text, failures.count()));
}

/// For the page: a test with all its histograms.
Json histograms(const DensityTest& test) {
    Json marginals = Json::array();
    for (const Marginal& m : test.marginals)
        marginals.push_back({{"name", m.name},
                             {"edges", m.edges},
                             {"observed", m.observed},
                             {"expected", m.expected},
                             {"standard_error", m.error},
                             {"chi_square", m.statistic},
                             {"degrees", m.degrees},
                             {"p", m.p}});
    return {{"class", test.what}, {"state", test.state}, {"proposals", test.proposals}, {"marginals", marginals}};
}

}  // namespace

Finding findStates(MutationCase& c) {
    Finding finding{.level = "", .check = "states"};
    for (const Space target : c.targets)
        for (const auto& scene : auditScenes()) {
            const Subject subject(c.name, target);
            Place place{scene.get(), target,
                        drawStates(*scene, subject, c.key, c.work().seedSamples, c.work().states),
                        fmt::format("{}, target over {}", scene->name, nameOf(target))};
            finding.numbers[place.text] = {{"drawn", place.states.drawn},
                                           {"with_light", place.states.positive},
                                           {"suitable", place.states.suitable}};
            finding.samples += place.states.drawn;
            if (target == c.targets.front())
                finding.summary += fmt::format("{}{} of {} in {}", finding.summary.empty() ? "applies to " : ", ",
                                               place.states.suitable, place.states.positive, scene->name);
            if (!place.states.x.empty()) c.places.push_back(std::move(place));
        }
    if (!c.places.empty()) return finding;
    finding.outcome = Outcome::NotCovered;
    finding.details.push_back("the mutation suits no state of any audit scene: nothing was audited");
    return finding;
}

Finding auditStructure(const MutationCase& c) {
    Finding finding{.level = "L0", .check = "structure"};
    StructureTally all;
    for (const Place& place : c.places) {
        const Subject subject(c.name, place.target, partnersOf(c.name, place.target));
        const auto tally = inParallel<StructureTally>(
            c.settings.threads, c.work().structure, kChunk, [&](uint64_t begin, uint64_t end) {
                return auditStructure(*place.scene, subject, place.states, c.key, begin, end);
            });
        take(finding, c, place, tally.failures);
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
    finding.statistic = double(all.failures.count());
    finding.samples = all.trials;
    finding.summary = fmt::format("{} trials, {} proposals, {} not finite", all.trials, all.proposals, all.notFinite);
    return finding;
}

Finding auditBalance(const MutationCase& c) {
    Finding finding{.level = "L1", .check = "balance"};
    BalanceTally all;
    for (const Place& place : c.places) {
        const Subject subject(c.name, place.target, partnersOf(c.name, place.target));
        const auto tally = inParallel<BalanceTally>(
            c.settings.threads, c.work().balance, kChunk, [&](uint64_t begin, uint64_t end) {
                return auditBalance(*place.scene, subject, place.states, c.key, begin, end);
            });
        take(finding, c, place, tally.failures);
        finding.numbers[place.text] = {{"steps", tally.steps},
                                       {"pairs", tally.pairs},
                                       {"worst_residual", numberOrText(tally.worst)},
                                       {"worst_trial", tally.worstTrial}};
        all.merge(tally);
    }
    finding.statistic = all.worst;
    finding.samples = all.pairs;
    finding.summary = fmt::format("{} pairs, worst residual {:.2g} (trial {})", all.pairs, all.worst, all.worstTrial);
    if (finding.outcome == Outcome::Rejected) return finding;
    if (!all.hasDensity)
        notAudited(finding, "the mutation has no logDensity");
    else if (all.pairs == 0)
        notAudited(finding, "no step had a proposal");
    return finding;
}

Finding auditJacobian(const MutationCase& c) {
    Finding finding{.level = "L1", .check = "jacobian"};
    JacobianVerdict all;
    uint64_t proposals = 0, noisy = 0, notSquare = 0;
    for (const Place& place : c.places) {
        if (place.target == Space::Primary) continue;
        const Subject subject(c.name, place.target);
        const auto tally = inParallel<JacobianTally>(
            c.settings.threads, c.work().jacobian, kChunk, [&](uint64_t begin, uint64_t end) {
                return auditJacobian(*place.scene, subject, place.states, c.key, begin, end);
            });
        const JacobianVerdict verdict = judge(tally);
        take(finding, c, place, verdict.failures);
        finding.numbers[place.text] = {{"proposals", tally.proposals},
                                       {"compared", verdict.comparisons},
                                       {"inverted", tally.plain},
                                       {"moved", tally.moved},
                                       {"equalities", verdict.equalities},
                                       {"classes", verdict.classes},
                                       {"classes_too_small", verdict.unjudged},
                                       {"noisy", tally.noisy},
                                       {"more_numbers_than_coordinates", tally.notSquare},
                                       {"largest_median", verdict.worst}};
        proposals += tally.proposals, noisy += tally.noisy, notSquare += tally.notSquare;
        all.comparisons += verdict.comparisons, all.equalities += verdict.equalities, all.classes += verdict.classes;
        all.worst = std::max(all.worst, verdict.worst);
    }
    finding.statistic = all.worst;
    finding.samples = all.comparisons;
    finding.summary = fmt::format(
        "{}{} of {} compared in {} classes, {} as equalities, {} noisy, {} not square; largest median {:.2g}",
        c.space == Space::Primary ? "map from numbers to paths: " : "", all.comparisons, proposals, all.classes,
        all.equalities, noisy, notSquare, all.worst);
    if (all.comparisons == 0) notAudited(finding, "no class of proposals could be compared");
    return finding;
}

Finding auditDensities(const MutationCase& c) {
    Finding finding{.level = "L2", .check = "density"};
    // A guide draws all numbers of a state, and none of it costs a ray.
    const uint64_t proposals = c.work().density / (c.space == Space::Primary ? 3 : 1);
    DensityTally all;
    std::vector<double> p;
    size_t classes = 0;
    std::string worst;
    const Place* worstPlace = nullptr;
    uint64_t worstState = 0;
    double smallest = 1;
    Json shown = Json::array();
    for (const Place& place : c.places) {
        const Subject subject(c.name, place.target);
        const size_t have = place.states.x.size(), count = std::min(have, c.work().densityStates);
        const auto tally =
            inParallel<DensityTally>(c.settings.threads, count, 1, [&](uint64_t begin, uint64_t) {
                // From all over the list: likely states stand first in it, rare ones last.
                const uint64_t state = begin * have / count + have / (2 * count);
                return auditDensity(*place.scene, subject, place.states.x[state], c.key, state, proposals);
            });
        take(finding, c, place, tally.failures);
        const DensityTest* odd = nullptr;
        double oddest = 2, deviation = 0;
        for (const DensityTest& test : tally.tests)
            for (const Marginal& m : test.marginals) {
                p.push_back(m.p);
                const double error = std::abs(m.observed[0] / m.expected[0] - 1);
                if (m.name == "all") deviation = std::max(deviation, error);
                if (m.p < oddest) oddest = m.p, odd = &test;
                if (m.p >= smallest) continue;
                smallest = m.p;
                worstPlace = &place, worstState = test.state;
                worst = fmt::format("{}, state {}: {} of {}, chi-square {:.4g} of {} degrees, p = {:.3g}", place.text,
                                    test.state, m.name, test.what, m.statistic, m.degrees, m.p);
            }
        if (odd) {
            Json one = histograms(*odd);
            one["place"] = place.text;
            shown.push_back(std::move(one));
        }
        classes += tally.tests.size();
        finding.numbers[place.text] = {{"states", tally.states},
                                       {"states_not_judged", tally.unjudged},
                                       {"classes", tally.tests.size()},
                                       {"largest_error_of_a_mass", numberOrText(deviation)}};
        all.merge(tally);
    }
    finding.numbers["histograms"] = std::move(shown);
    const double adjusted = p.empty() ? 1 : -std::expm1(double(p.size()) * std::log1p(-smallest));  // Šidák
    if (!p.empty()) finding.p = adjusted, finding.statistic = smallest;
    finding.samples = classes * proposals;
    finding.numbers["tests"] = p.size();
    finding.numbers["most_deviating"] = worst;
    finding.summary = fmt::format("{} tests of {} classes of proposals from {} of {} states, p = {:.2g}", p.size(),
                                  classes, all.states - all.unjudged, all.states, adjusted);
    if (adjusted < c.ownLevel(kSuiteLevel)) {
        finding.outcome = Outcome::Rejected;
        finding.details.push_back(fmt::format("{}; ulam replay-path {}", worst, trialToken(c, *worstPlace, finding.check, worstState)));
    }
    if (finding.outcome == Outcome::Rejected) return finding;
    if (!all.hasDensity)
        notAudited(finding, "the mutation has no logDensity");
    else if (p.empty())
        notAudited(finding, "no proposals with a density could be made independently");
    return finding;
}

}  // namespace ulam::verify
