// The image of a work budget is the same bytes, however the work is shared out or interrupted.


#include "core/render/driver.h"
#include "tests/core/render/same_bytes.h"
#include "tests/support/known_answers.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

namespace {

struct Task {
    Json sampler;
    Budget budget;
};

/// Every sampler that works in any scene, with a budget of each kind.
std::vector<Task> tasks() {
    std::vector<Task> all;
    for (const std::string& name : samplerNames()) {
        if (name == "portal") continue;  // needs a scene with openings
        Json sampler = {{"type", name}, {"max_depth", 5}};
        const bool chains = isChainSampler(name);
        if (chains) sampler["chains"] = 37, sampler["bootstrap"] = 5000;
        Budget spp, mutations, rays;
        spp.spp = 6.5, mutations.mutations = 12'345, rays.rays = 500'000;
        all.push_back({sampler, spp});
        all.push_back({sampler, rays});
        if (chains) all.push_back({sampler, mutations});
    }
    return all;
}

RenderResult run(const Scene& scene, const Task& task, int threads, int snapshots = 0,
                 const std::optional<PreviewPlan>& preview = {}) {
    const auto sampler = Registry<Sampler>::instance().create(JsonNode(task.sampler));
    RenderOptions options;
    options.budget = task.budget;
    options.key = makeKey(5);
    options.threads = threads;
    options.snapshots = snapshots;
    options.preview = preview;
    return render(scene, *sampler, options);
}

}  // namespace

TEST_CASE("the same work gives the same bytes with 1, 2, 3 and 8 threads") {
    const Scene scene = buildScene(pathScene("glass_and_mirror").dictionary);
    for (const Task& task : tasks()) {
        INFO(task.sampler.dump());
        const RenderResult one = run(scene, task, 1);
        double sum = 0;
        for (const Rgb& p : one.image.pixels) sum += p.x;
        REQUIRE(sum > 0);
        for (const int threads : {2, 3, 8}) {
            INFO(threads << " threads");
            const RenderResult many = run(scene, task, threads);
            CHECK(many.units == one.units);
            CHECK(many.statistics.rays == one.statistics.rays);
            CHECK(many.statistics.featureEnergy == one.statistics.featureEnergy);
            CHECK(many.statistics.featureJumps == one.statistics.featureJumps);
            CHECK(sameBytes(many.image, one.image));
        }
    }
}

TEST_CASE("another seed gives another image") {
    const Scene scene = buildScene(pathScene("diffuse").dictionary);
    for (const Task& task : tasks()) {
        const auto sampler = Registry<Sampler>::instance().create(JsonNode(task.sampler));
        RenderOptions options;
        options.budget = task.budget;
        options.key = makeKey(5, 0, 1);
        CHECK_FALSE(sameBytes(render(scene, *sampler, options).image, run(scene, task, 1).image));
    }
}

TEST_CASE("snapshots do not change the result, and are results themselves") {
    const Scene scene = buildScene(pathScene("diffuse").dictionary);
    for (const Task& task : tasks()) {
        INFO(task.sampler.dump());
        const RenderResult plain = run(scene, task, 2), stopped = run(scene, task, 2, 3);
        CHECK(stopped.units == plain.units);
        CHECK(sameBytes(stopped.image, plain.image));
        REQUIRE(stopped.snapshots.size() == 3);
        if (task.budget.rays) continue;
        for (const Snapshot& snapshot : stopped.snapshots) {
            // As a run of that much work, with the seeding of the whole.
            Task part = task;
            const double units =
                isChainSampler(task.sampler["type"]) ? double(snapshot.mutations) : double(snapshot.samples);
            part.budget = {};
            part.budget.spp = units / double(plain.image.pixels.size());
            CHECK(sameBytes(run(scene, part, 3).image, snapshot.image));
        }
    }
}

TEST_CASE("previews do not change the result, and the last is the image") {
    const Scene scene = buildScene(pathScene("diffuse").dictionary);
    for (const Task& task : tasks()) {
        INFO(task.sampler.dump());
        std::vector<Image> shown;
        const PreviewPlan preview{.show = [&](Image image) { shown.push_back(std::move(image)); }, .interval = 1e-4};
        const RenderResult plain = run(scene, task, 1), watched = run(scene, task, 2, 1, preview);
        CHECK(watched.units == plain.units);
        CHECK(watched.statistics.rays == plain.statistics.rays);
        CHECK(sameBytes(watched.image, plain.image));
        REQUIRE(shown.size() > 1);
        CHECK(sameBytes(shown.back(), plain.image));
        CHECK_FALSE(sameBytes(shown.front(), plain.image));
        CHECK(watched.previewSeconds > 0);
        CHECK(plain.previewSeconds == 0);
    }
}

TEST_CASE("a run that was stopped is repeated exactly by the work it did") {
    const Scene scene = buildScene(pathScene("diffuse").dictionary);
    for (const std::string& name : samplerNames()) {
        if (name == "portal") continue;
        INFO(name);
        Task task{{{"type", name}, {"max_depth", 5}}, {}};
        const bool chains = isChainSampler(name);
        if (chains) task.sampler["chains"] = 37, task.sampler["bootstrap"] = 5000;
        task.budget.spp = 1e6;
        // Stopped from outside after some chunks.
        std::atomic<bool> interrupt = false;
        std::atomic<int> calls = 0;
        const auto sampler = Registry<Sampler>::instance().create(JsonNode(task.sampler));
        RenderOptions options;
        options.budget = task.budget;
        options.key = makeKey(5);
        options.threads = 2;
        options.interrupt = &interrupt;
        options.progress = [&](double done) { interrupt = done > 0 && ++calls > 1; };  // seeding may take a while
        const RenderResult stopped = render(scene, *sampler, options);
        CHECK(stopped.interrupted);
        REQUIRE(stopped.units > 0);
        task.budget.spp = double(stopped.units) / double(stopped.image.pixels.size());
        const RenderResult again = run(scene, task, 1);
        CHECK(again.units == stopped.units);
        CHECK(sameBytes(again.image, stopped.image));
    }
}

TEST_CASE("the bootstrap is planned alike with any number of threads, and a repetition that knows its size needs no plan") {
    const Scene scene = buildScene(pathScene("glass_and_mirror").dictionary);
    Budget mutations, rays;
    mutations.mutations = 20'000, rays.rays = 300'000;
    for (const char* name : {"mlt", "pssmlt"})
        for (const Budget& budget : {mutations, rays}) {
            Task task{{{"type", name}, {"max_depth", 5}, {"chains", 37}}, budget};
            INFO(task.sampler.dump());
            const RenderResult one = run(scene, task, 1), three = run(scene, task, 3);
            CHECK(three.statistics.diagnostics == one.statistics.diagnostics);
            CHECK(sameBytes(three.image, one.image));
            task.sampler["bootstrap"] = one.statistics.diagnostics["bootstrap_samples"];
            task.budget = {};
            task.budget.mutations = double(one.units);
            CHECK(sameBytes(run(scene, task, 2).image, one.image));
        }
}
