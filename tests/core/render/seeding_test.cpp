// The bootstrap: its numbers, moments, size and starts against their definitions, and the promise of its size in renders.

#include "core/render/seeding.h"

#include <cmath>

#include "core/image/film.h"
#include "experiments/statistics/goodness_of_fit.h"
#include "tests/support/chi_square.h"
#include "tests/support/known_answers.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

namespace {

/// A smooth function of all that is drawn, with mean 1.
double smooth(Random& random) {
    double product = 1;
    for (int b = 0; b < 4; ++b)
        for (const double u : random.nextBlock()) product *= 0.75 + u / 2;
    return product;
}

/// Rare and large as light through a hole: one sample in a thousand counts.
double rare(Random& random) {
    const Block raster = random.nextBlock(), other = random.nextBlock();
    return raster[0] < 0.1 && raster[1] < 0.1 && other[3] < 0.1 ? 1000 * other[1] * 2 : 0;
}

std::vector<double> weights(const BootstrapNumbers& numbers, uint64_t count, double (*f)(Random&)) {
    std::vector<double> w(count);
    for (uint64_t i = 0; i < count; ++i) w[i] = numbers.with(i, f);
    return w;
}

}  // namespace

TEST_CASE("numbers of a bootstrap sample repeat, and differ between samples and streams") {
    const BootstrapNumbers a(makeKey(1), 5), b(makeKey(1), 6);
    auto first = [](Random& random) { return random.nextBlock()[0]; };
    CHECK(a.with(3, first) == a.with(3, first));
    CHECK(a.with(3, first) != a.with(4, first));
    CHECK(a.with(3, first) != b.with(3, first));
}

TEST_CASE("every bootstrap sample is uniform in the numbers that are spread evenly and in the others") {
    std::vector<std::vector<double>> counts(16, std::vector<double>(50));
    const std::vector<double> flat(50, 0.02);
    for (uint64_t key = 0; key < 20'000; ++key)
        BootstrapNumbers(makeKey(key), 5).with(40, [&](Random& random) {
            for (size_t b = 0; b < 4; ++b) {
                const Block block = random.nextBlock();
                for (size_t k = 0; k < 4; ++k) ++counts[4 * b + k][size_t(block[k] * 50)];
            }
            return 0;
        });
    for (const auto& c : counts) CHECK_FIT(misfit(c, flat));
}

TEST_CASE("the mean over a stratified bootstrap is unbiased and its standard error is what is reported") {
    for (const auto& f : {smooth, rare}) {
        for (const uint64_t count : {1000, 5003}) {
            constexpr int kRuns = 2000;
            std::vector<double> means;
            double squares = 0, reported = 0, stratification = 0;
            for (int run = 0; run < kRuns; ++run) {
                const WeightMoments m(weights(BootstrapNumbers(makeKey(7, count, uint64_t(run)), 5), count, f));
                means.push_back(m.mean);
                squares += (m.mean - 1) * (m.mean - 1) / kRuns;
                reported += m.standardError * m.standardError / kRuns;
                stratification += m.stratification / kRuns;
            }
            CAPTURE(count, squares, reported, stratification);
            CHECK(deviation(means, 1).p > 1e-5);
            CHECK(reported / squares == Approx(1).margin(0.15));  // 4.5 standard deviations of 2000 squares
            // Smooth: the error is mostly that of the nine numbers that stay independent.
            if (f == smooth) CHECK(stratification < 0.8);
            if (f == rare) CHECK(stratification < 1.05);
        }
    }
}

TEST_CASE("moments of few weights") {
    CHECK(WeightMoments(std::vector<double>{}).mean == 0);
    const WeightMoments one(std::vector<double>{3});
    CHECK(one.mean == 3);
    CHECK(one.standardError == 0);
    CHECK(one.effective == 1);
    // Fewer weights than sets: each is a set of its own, and the standard error is the textbook's.
    const WeightMoments four(std::vector<double>{0, 0, 4, 0});
    CHECK(four.mean == 1);
    CHECK(four.standardError == Approx(1));
    CHECK(four.effective == 1);
    const WeightMoments none(std::vector<double>(100, 0.0));
    CHECK(none.mean == 0);
    CHECK(none.effective == 0);
}

TEST_CASE("every chain's start is drawn by weight, at a uniform place inside the sample") {
    const std::vector<double> w = {0, 3, 0.5, 0, 0, 1, 2.5, 0, 3};
    constexpr size_t kChains = 4, kRuns = 40'000;
    std::vector<std::vector<double>> counts(kChains, std::vector<double>(w.size()));
    std::vector<double> probabilities;
    for (const double x : w) probabilities.push_back(x / 10);
    std::vector<double> choices;
    for (size_t run = 0; run < kRuns; ++run) {
        Random random(makeKey(2), 0, run);
        const std::vector<Start> starts = drawStarts(w, kChains, random);
        REQUIRE(starts.size() == kChains);
        for (size_t c = 0; c < kChains; ++c) ++counts[c][starts[c].sample];
        if (starts[0].sample == 6) choices.push_back(starts[0].choice);
    }
    for (const auto& c : counts) CHECK_FIT(misfit(c, probabilities));
    CHECK(statistics::uniformityTest(choices).p > 1e-5);
}

TEST_CASE("chains are spread over the bootstrap evenly, and over the parts of one sample") {
    const std::vector<double> w = {1, 0, 2, 5};
    for (uint64_t run = 0; run < 100; ++run) {
        Random random(makeKey(4), 0, run);
        std::vector<double> counts(w.size()), lowerHalf(w.size());
        for (const Start& s : drawStarts(w, 80, random)) ++counts[s.sample], lowerHalf[s.sample] += s.choice < 0.5;
        for (size_t i = 0; i < w.size(); ++i) {
            CHECK(std::abs(counts[i] - 10 * w[i]) <= 1);
            CHECK(std::abs(lowerHalf[i] - 5 * w[i]) <= 1);
        }
    }
}

TEST_CASE("the size of the bootstrap follows its rule") {
    WeightMoments pilot;
    pilot.samples = 10'000;
    pilot.mean = 2;
    pilot.standardError = 0.04;  // 2 % of b at 10 000 samples
    pilot.effective = 500;
    // 65 536 pixels, a million mutations: e = 25.6 %, so b is wanted to 2.56 %, with a variance to be cautious about by 2.
    SeedingTask task{.sampleCost = 1e-8, .mutationCost = 1e-6, .pixels = 65536, .chains = 1000};
    const SeedingPlan plan(pilot, task);
    CHECK(plan.expectedError == Approx(0.256));
    CHECK(plan.samplesForScale == Approx(2 * 10'000 * std::pow(0.02 / 0.0256, 2)));
    CHECK(plan.samplesForStarts == Approx(20'000));
    CHECK(plan.samplesForSmallestShare == Approx(5e6));
    CHECK(plan.samplesForLargestShare == Approx(5e7));
    CHECK(plan.samples == 5'000'000);
    task.sampleCost = 3e-6;
    CHECK(SeedingPlan(pilot, task).samples == uint64_t(plan.samplesForStarts));
    task.chains = 10;
    CHECK(SeedingPlan(pilot, task).samples == uint64_t(0.05 / 3e-6));
    pilot.standardError = 0.08;
    CHECK(SeedingPlan(pilot, task).samples == uint64_t(4 * plan.samplesForScale));
    pilot.standardError = 1;
    CHECK(SeedingPlan(pilot, task).samples == uint64_t(0.5 / 3e-6));
    // Nothing is known of b: as much as is allowed.
    CHECK(SeedingPlan(WeightMoments(std::vector<double>(100, 0.0)), task).samples == uint64_t(0.5 / 3e-6));
    task.sampleCost = 1;
    CHECK(SeedingPlan(pilot, task).samples == uint64_t(SeedingPlan::kFewest));
    task.sampleCost = 1e-12;
    CHECK(SeedingPlan(pilot, task).samples == uint64_t(SeedingPlan::kMost));
}

// Runs with seeds of their own: the scale b scatters by less than a tenth of the error that the plan expects, and the
// image of a run, divided by its b, by no less than that error.
TEST_CASE("the standard error of b is below a tenth of the expected error of the image") {
    const std::vector<std::pair<std::string, Json>> cases = {
        {"glass_and_mirror", {{"type", "mlt"}, {"max_depth", 5}, {"chains", 50}}},
        {"diffuse", {{"type", "pssmlt"}, {"max_depth", 5}, {"chains", 50}, {"base", "path"}, {"deposit", "expected_values"}}}};
    for (const auto& [name, sampler] : cases) {
        INFO(name);
        // Large enough that the largest share does not rule.
        const Scene scene = buildScene(pathScene(name).dictionary, {{"width", 128}, {"height", 96}});
        constexpr int kRuns = 40;
        Budget budget;
        budget.spp = 8;
        const std::vector<RenderResult> runs = renderRuns(scene, sampler, budget, kRuns, 11);
        double b = 0, reported = 0, expected = 0;
        std::vector<double> pixels(runs[0].image.pixels.size()), squares(pixels.size());
        for (const RenderResult& run : runs) {
            const Json& plan = run.statistics.diagnostics["seeding_plan"];
            CHECK(plan["samples"] < plan["samples_for_largest_share"]);
            b += run.statistics.normalization / kRuns;
            reported += std::pow(run.statistics.normalizationStandardError, 2) / kRuns;
            expected += plan["expected_error"].get<double>() / kRuns;
            for (size_t i = 0; i < pixels.size(); ++i) {
                const double value = luminance(run.image.pixels[i]) / run.statistics.normalization;
                pixels[i] += value / kRuns;
                squares[i] += value * value / kRuns;
            }
        }
        double variance = 0, mean = 0, imageVariance = 0;
        for (const RenderResult& run : runs) variance += std::pow(run.statistics.normalization / b - 1, 2) / (kRuns - 1);
        for (size_t i = 0; i < pixels.size(); ++i) {
            mean += pixels[i] / double(pixels.size());
            imageVariance += (squares[i] - pixels[i] * pixels[i]) * kRuns / (kRuns - 1) / double(pixels.size());
        }
        const double measured = std::sqrt(imageVariance) / mean;
        CAPTURE(std::sqrt(variance), std::sqrt(reported) / b, expected, measured);
        CHECK(std::sqrt(variance) < 0.1 * expected);
        CHECK(expected < measured);
        // χ² with 39 degrees of freedom: within a factor of 2 (p < 1e-3 a side).
        CHECK(reported / (b * b) / variance > 0.5);
        CHECK(reported / (b * b) / variance < 2);
    }
}
