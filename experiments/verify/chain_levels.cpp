// Levels that run chains: invariance and images, of the mutation alone and among partners, and how well it mixes.

#include "core/mcmc/audit/invariance.h"
#include "core/mcmc/audit/rank.h"
#include "core/mcmc/audit/sequential.h"
#include "experiments/engine/mixing.h"
#include "experiments/verify/mutation_levels.h"

namespace ulam::verify {
namespace {

using namespace audit;

// Many chains of a few steps: a lone mutation need not reach every state.
constexpr double kStepsPerChain = 64;

/// Somebody to mix with who reaches every state.
std::string ergodicPartner(const std::string& mutation, Space mutationSpace, Space target) {
    if (target == Space::Path && mutationSpace == Space::Path)
        return mutation == "bidirectional" ? "large_step" : "bidirectional";
    return mutation == "large_step" ? "kelemen_step" : "large_step";
}

/// The mutation alone, or at a random weight among partners at other random weights. The ergodic partner is one of them.
Json mixOf(const MutationCase& c, Space target, bool mixed) {
    Json mix = {{c.name, {{"weight", 1}}}};
    if (!mixed) return mix;
    Random random = randomOf(c.key, Stream::Mix, uint64_t(target));
    std::vector<std::string> partners = partnersOf(c.name, target);
    const std::string ergodic = ergodicPartner(c.name, c.space, target);
    std::erase(partners, ergodic);
    std::erase(partners, "identity");  // it would take steps away and test nothing
    while (partners.size() + 1 > c.work().partners) partners.erase(partners.begin() + random.index(int(partners.size())));
    partners.insert(partners.begin(), ergodic);
    const auto weight = [&] { return 0.25 * std::exp(random() * std::log(8.0)); };
    mix[c.name] = {{"weight", weight()}};
    for (const std::string& partner : partners) mix[partner] = {{"weight", weight()}};
    return mix;
}

std::string mixText(const Json& mix) {
    std::string text;
    for (const auto& [name, entry] : mix.items())
        text += fmt::format("{}{} {:.2f}", text.empty() ? "" : ", ", name, entry["weight"].get<double>());
    return text;
}

Finding invariance(const MutationCase& c, bool mixed) {
    Finding finding{.level = mixed ? "L6" : "L4", .check = mixed ? "mixed invariance" : "invariance"};
    uint64_t starts = 0, steps = 0;
    size_t tests = 0;
    std::string worst;
    const double level = c.ownLevel(kSuiteLevel);
    const SequentialResult result = sequentialTest(level, [&](int round, double size) {
        const RandomKey key = makeKey(c.settings.seed, cellOf(c.name + finding.level), uint64_t(round) + 1);
        double smallest = 1;
        tests = 0;
        const auto judgeTest = [&](double p, const std::string& what) {
            ++tests;
            if (p < smallest) smallest = p, worst = what;
        };
        for (const Place& place : c.places) {
            const Subject subject(place.target, mixOf(c, place.target, mixed));
            const TestFunctions functions(*place.scene, subject, key);
            const auto count =
                uint64_t(double(c.work().starts) * size / (place.target == Space::Primary ? 4 : 1));
            const auto tally = inParallel<InvarianceTally>(
                c.settings.threads, count, kChunk, [&](uint64_t begin, uint64_t end) {
                    return audit::auditInvariance(*place.scene, subject, functions, key, begin, end);
                });
            starts += tally.starts, steps += tally.steps;
            for (const IdentityTest& test : identityTests(functions, tally))
                judgeTest(test.p, fmt::format("{}: {} (z = {:.2f})", place.text, test.name, test.z));
        }
        if (c.space == Space::Primary) {
            const Subject subject(Space::Primary, mixOf(c, Space::Primary, mixed));
            const auto ranks = inParallel<RankTally>(
                c.settings.threads, uint64_t(double(c.work().ranks) * size), kChunk, [&](uint64_t begin, uint64_t end) {
                    return auditRanks(*auditScenes().front(), subject, key, begin, end);
                });
            judgeTest(rankTest(ranks), "ranks of exact starts on a toy target");
        }
        return -std::expm1(double(tests) * std::log1p(-smallest));  // Šidák
    });
    finding.p = result.p;
    finding.samples = starts;
    finding.summary = fmt::format("{} tests of {} steps from {} starts, p = {:.2g} in round {}", tests, steps, starts,
                                  result.p, result.rounds);
    finding.numbers = {{"tests", tests},          {"starts", starts}, {"steps", steps},         {"p", result.p},
                       {"rounds", result.rounds}, {"level", level},   {"most_deviating", worst}};
    if (mixed)
        for (const Space target : c.targets)
            finding.numbers["mix"][target == Space::Path ? "paths" : "numbers"] = mixText(mixOf(c, target, true));
    if (!result.rejected) return finding;
    finding.outcome = Outcome::Rejected;
    finding.details.push_back(fmt::format("p = {:.3g}; most deviating: {}", result.p, worst));
    return finding;
}

/// Sampler and budget of the image runs in a place, at `factor` times the work.
struct ImageRun {
    ImageRun(const MutationCase& c, const Place& place, bool mixed, double factor = 1) {
        const Work& work = c.work();
        const bool onPaths = place.target == Space::Path;
        sampler = samplerConfig(onPaths ? "mlt" : "pssmlt", *place.scene);
        budget.mutations = factor * (onPaths ? work.pathMutations : work.primaryMutations);
        sampler["chains"] = std::llround(*budget.mutations / kStepsPerChain);
        sampler["bootstrap"] = std::llround(std::max(1000.0, work.bootstrap * factor));
        sampler["mutations"] = mixOf(c, place.target, mixed);
        text = fmt::format("{} by {}, {}", place.scene->name, onPaths ? "mlt" : "pssmlt", mixed ? "mixed" : "alone");
    }
    Json sampler;
    Budget budget;
    std::string text;
};

Finding images(const MutationCase& c, References& references, bool mixed) {
    const Work& work = c.work();
    const auto& scenes = mixed ? work.mixedImages : work.aloneImages;
    std::vector<ImageComparison> comparisons;
    for (const Place& place : c.places) {
        const auto scene = std::find(scenes.begin(), scenes.end(), place.scene->name);
        if (scene == scenes.end()) continue;
        // Targets take turns: what a scene has not shown of the mutation alone it shows of the mix.
        const size_t turn = size_t(scene - scenes.begin()) + size_t(mixed);
        if (place.target != c.targets[turn % c.targets.size()]) continue;
        const auto render = [&](double factor, int runs, const char* part) {
            const ImageRun run(c, place, mixed, factor);
            return renderTiled(place.scene->scene, run.sampler, run.budget, runs, c.settings.seed,
                               cellOf(c.name + run.text + part), c.settings.threads);
        };
        // Bounded, since a mutation that is wrong may leave an interval as wide as it likes.
        constexpr double kMost = 3;
        const TiledEstimate runs = preciseRuns(work, render, kPilotShare, kMost);
        comparisons.push_back(compare(ImageRun(c, place, mixed).text, runs, references(*place.scene)));
    }
    Finding finding = judgeImages(comparisons, work);
    if (mixed) finding.level = "L6", finding.check = "mixed images";
    return finding;
}

}  // namespace

Finding auditInvariance(const MutationCase& c) { return invariance(c, false); }
Finding auditMixedInvariance(const MutationCase& c) { return invariance(c, true); }
Finding auditImages(const MutationCase& c, References& r) { return images(c, r, false); }
Finding auditMixedImages(const MutationCase& c, References& r) { return images(c, r, true); }

Finding reportMixing(const MutationCase& c, References& references) {
    Finding finding{.level = "L7", .check = "mixing", .outcome = Outcome::Reported};
    for (const Place& place : c.places) {
        const auto& scenes = c.work().mixedImages;
        if (std::find(scenes.begin(), scenes.end(), place.scene->name) == scenes.end()) continue;
        for (const bool mixed : {false, true}) {
            ImageRun run(c, place, mixed);
            const auto chains = c.work().mixingChains;
            run.sampler["chains"] = chains;
            run.budget.mutations = c.work().mixingSteps * double(chains);
            RenderOptions options;
            options.budget = run.budget;
            options.key = makeKey(c.settings.seed, cellOf("mixing " + c.name + run.text));
            options.threads = c.settings.threads;
            const auto made = Registry<Sampler>::instance().create(JsonNode(run.sampler));
            const RenderResult result = render(place.scene->scene, *made, options);
            const auto& own = result.statistics.mutationStatistics.at(c.name);
            Json numbers = {{"acceptance", own.proposed ? double(own.accepted) / double(own.proposed) : 0},
                            {"chains", chains},
                            {"steps_per_chain", c.work().mixingSteps},
                            {"coverage_of_lit_tiles", coverage(result.image, references(*place.scene))}};
            const Json scalars = mixing(result.statistics.traces, result.cpuSeconds, c.settings.threads);
            std::string slowest;
            double longest = 0;
            for (const auto& [name, scalar] : scalars.items()) {
                if (!scalar.is_object() || name == "feature") continue;
                const Json& time = scalar.at("integrated_autocorrelation_mutations");
                if (time.is_number() && time > longest) longest = time, slowest = name;
            }
            if (place.scene == c.places.front().scene || finding.summary.empty())
                finding.summary += fmt::format("{}{}: acceptance {:.0f} %, {} of {:.0f} steps, covers {:.0f} %", finding.summary.empty() ? "" : "; ",
                                               run.text, 100 * numbers["acceptance"].get<double>(), slowest, longest,
                                               100 * numbers["coverage_of_lit_tiles"].get<double>());
            numbers["scalars"] = scalars;
            finding.samples += uint64_t(*run.budget.mutations);
            finding.numbers[run.text] = std::move(numbers);
        }
    }
    return finding;
}

}  // namespace ulam::verify
