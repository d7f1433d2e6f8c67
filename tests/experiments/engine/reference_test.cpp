#include "experiments/engine/reference.h"

#include <functional>

#include "core/image/image_io.h"
#include "experiments/engine/replicate.h"
#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;
namespace fs = std::filesystem;

namespace {

/// Parts of an image of 32 × 16: uniform noise around 1, and the odd parts brighter by `shift` in the
/// right tile.
std::vector<Image> noisyParts(double shift) {
    std::vector<Image> parts;
    Random random(makeKey(5), 0, 0);
    for (int p = 0; p < 16; ++p) {
        Image image(32, 16);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 32; ++x) image.at(x, y) = Rgb(float(0.5 + random() + (p % 2 == 1 && x >= 16 ? shift : 0)));
        parts.push_back(image);
    }
    return parts;
}

CombinedParts combined(const std::vector<Image>& parts, CombinedParts before = {}) {
    for (const Image& part : parts) before.add(part);
    return before;
}

/// tinyExperiment with another budget of its reference, in parts of 32 samples a pixel.
Plan planWithReference(const Folder& folder, double spp) {
    Json experiment = tinyExperiment();
    experiment["reference"]["budget"]["spp"] = spp;
    return planOf(folder, experiment);
}

/// The stored reference, byte by byte, but for what it took.
std::vector<std::string> contentOf(const fs::path& folder) {
    Json result = JsonDocument::fromFile(folder / "result.json").json();
    result.erase("wall_seconds");
    return {readFile(folder / "image.exr"), readFile(folder / "variance.exr"), result.dump()};
}

fs::path writeTinyReference(const Folder& folder) {
    Image image(16, 16, Rgb(0.5f)), variance(16, 16, Rgb(1e-4f));
    writeExr(folder / "known.exr", image);
    writeExr(folder / "known.variance.exr", variance);
    return folder / "known.exr";
}

}  // namespace

TEST_CASE("parts give a mean and its variance", "[reference]") {
    const CombinedParts parts = combined(noisyParts(0));
    double mean = 0, variance = 0;
    for (std::size_t i = 0; i < parts.image.pixels.size(); ++i) {
        mean += parts.image.pixels[i].x / double(parts.image.pixels.size());
        variance += parts.variance.pixels[i].x / double(parts.image.pixels.size());
    }
    // 512 pixels of the mean of 16 numbers of variance 1/12: standard errors 0.0032 and about 1.4e-4.
    CHECK(mean == Approx(1).margin(0.02));
    CHECK(variance == Approx(1.0 / 12 / 16).margin(7e-4));
}

TEST_CASE("halves that differ in one tile are found", "[reference]") {
    CHECK(combined(noisyParts(0)).smallestP() > kHalvesLevel);
    CHECK(combined(noisyParts(0.1)).smallestP() < kHalvesLevel);
}

TEST_CASE("a reference is made in parts and cached across runs", "[reference]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    const PlannedReference& planned = plan.references.at(0);
    CHECK_FALSE(prepareReference(planned, folder / "run"));
    runIn(folder, plan);
    const fs::path made = folder / "run" / "references" / planned.key;
    for (const char* file : {"image.exr", "variance.exr", "result.json"}) {
        CHECK(fs::exists(made / file));
        CHECK(fs::exists(referenceCache() / planned.key / file));
    }
    CHECK_FALSE(fs::exists(made / "parts"));
    const Reference reference = readReference(planned, folder / "run");
    CHECK(reference.halvesAgree);
    double variance = 0;
    for (const Rgb& v : reference.variance.pixels) variance += v.x;
    CHECK(variance > 0);

    // Another run takes it from the cache, byte by byte.
    CHECK(prepareReference(planned, folder / "second"));
    CHECK(readFile(folder / "second" / "references" / planned.key / "image.exr") == readFile(made / "image.exr"));
}

TEST_CASE("a damaged reference is made again, in the run and in the cache", "[reference]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    const PlannedReference& planned = plan.references.at(0);
    runIn(folder, plan);
    const fs::path made = folder / "run" / "references" / planned.key, cached = referenceCache() / planned.key;
    const Json intact = JsonDocument::fromFile(made / "result.json").json();
    const Reference before = readReference(planned, folder / "run");
    CHECK(intact["image_sha256"] == imageHash(before.image));
    CHECK(intact["variance_sha256"] == imageHash(before.variance));

    const auto without = [&](const char* field) {
        Json less = intact;
        less.erase(field);
        return [less](const fs::path& place) { writeFileAtomically(place / "result.json", less.dump()); };
    };
    const std::vector<std::function<void(const fs::path&)>> damages = {
        without("image_sha256"),
        without("variance_sha256"),
        without("halves_agree"),
        without("feature_shares"),
        without("key"),
        [](const fs::path& place) { writeFileAtomically(place / "result.json", "{"); },
        [](const fs::path& place) { writeFileAtomically(place / "image.exr", "text"); },
        [](const fs::path& place) { writeExr(place / "image.exr", Image(16, 16, Rgb(1))); },
        [](const fs::path& place) { writeExr(place / "variance.exr", Image(8, 8, Rgb(0))); },
        [](const fs::path& place) { fs::remove(place / "variance.exr"); },
        [](const fs::path& place) { fs::remove(place / "result.json"); },
    };
    for (const auto& damage : damages) {
        // In the run it is taken from the cache again.
        damage(made);
        CHECK(prepareReference(planned, folder / "run"));
        CHECK(readReference(planned, folder / "run").image == before.image);
        // In the cache it is removed, not copied.
        damage(cached);
        CHECK(cachedParts(planned) == 0);
        CHECK_FALSE(prepareReference(planned, folder / "second"));
        CHECK_FALSE(fs::exists(folder / "second" / "references" / planned.key / "image.exr"));
        CHECK_FALSE(fs::exists(cached));
        fs::copy(made, cached);
    }

    // Damaged in both places it is made anew, the same as before, and cached again.
    damages.front()(made);
    damages.front()(cached);
    runIn(folder, plan);
    CHECK(readReference(planned, folder / "run").image == before.image);
    CHECK(cachedParts(planned) == 8);
}

TEST_CASE("what changes a reference changes its key", "[reference]") {
    const Folder folder;
    const auto key = [&](const std::string& path, const Json& value) {
        Json experiment = tinyExperiment();
        if (!path.empty()) setValueByPath(experiment, path, value);
        return planOf(folder, experiment).references.at(0).key;
    };
    const std::string plain = key("", {});
    CHECK(key("seed", 7) == plain);
    CHECK(key("budget.spp", 7) == plain);
    CHECK(key("max_depth", 4) != plain);
    CHECK(key("film.height", 8) != plain);
    CHECK(key("reference.sampler", "path") != plain);
    CHECK(key("reference.budget.spp", 512) == plain);
    CHECK(key("reference.part.spp", 64) != plain);
    CHECK(key("scenes.wall.lamp.emitter.radiance", 3) != plain);
}

TEST_CASE("a budget says how many parts a reference has", "[reference]") {
    const Folder folder;
    const auto task = [&](const Json& budget, const Json& part = nullptr, const char* sampler = "bdpt") {
        Json experiment = tinyExperiment();
        experiment["reference"] = {{"sampler", sampler}, {"budget", budget}};
        if (!part.is_null()) experiment["reference"]["part"] = part;
        return planOf(folder, experiment).references.at(0).task;
    };
    // Rounded up to an even number of at least four.
    for (const auto& [spp, parts] : {std::pair(1, 4), {128, 4}, {129, 6}, {250, 8}, {256, 8}, {257, 10}})
        CHECK(task({{"spp", spp}}, {{"spp", 32}}).replicates == parts);
    CHECK(task({{"spp", 4.2}}, {{"spp", 0.7}}).replicates == 6);  // 6.000000000000001 in binary
    // The first limit that is reached counts.
    CHECK(task({{"spp", 320}, {"time", 100}}, {{"spp", 32}, {"time", 1}}).replicates == 10);
    CHECK(task({{"spp", 320}, {"time", 6}}, {{"spp", 32}, {"time", 1}}).replicates == 6);
    // Usual parts do not depend on the whole.
    const double pixels = 16 * 16;
    const auto isOf = [&](const Task& found, const Json& part, int parts) {
        CHECK(budgetJson(found.budget) == part);
        CHECK(found.replicates == parts);
    };
    for (const int times : {4, 16, 1000}) {
        isOf(task({{"spp", 64 * times}}), {{"spp", 64.0}}, times);
        isOf(task({{"time", 2 * times}}), {{"time", 2.0}}, times);
        isOf(task({{"rays", 640 * pixels * times}}), {{"rays", 640 * pixels}}, times);
        isOf(task({{"mutations", 64 * pixels * times}}, nullptr, "mlt"), {{"mutations", 64 * pixels}}, times);
    }
}

TEST_CASE("a run that asks for several budgets of one reference makes the largest", "[reference]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    for (const Json& budgets : {Json{128, 512, 256}, Json{512, 128, 256}}) {
        experiment["sweep"] = {{"reference.budget.spp", budgets}};
        const Plan plan = planOf(folder, experiment);
        REQUIRE(plan.references.size() == 1);
        CHECK(plan.references[0].task.replicates == 16);
    }
}

TEST_CASE("parts that are combined later come to the same", "[reference]") {
    const std::vector<Image> all = noisyParts(0.05);
    const CombinedParts once = combined(all);
    for (const std::ptrdiff_t first : {1, 4, 7, 15}) {
        // Between the two it is stored and read.
        CombinedParts stored = combined({all.begin(), all.begin() + first});
        if (first > 1)
            stored.halves = halvesFromJson(JsonDocument::fromText(dump(halvesJson(stored)), "halves").root());
        const CombinedParts twice = combined({all.begin() + first, all.end()}, stored);
        CHECK(twice.parts == once.parts);
        CHECK(twice.image == once.image);
        CHECK(twice.variance == once.variance);
        CHECK(halvesJson(twice) == halvesJson(once));
        CHECK(twice.smallestP() == once.smallestP());
    }
}

TEST_CASE("a larger budget extends a reference, a smaller one takes what is there", "[reference]") {
    const Folder folder;
    const fs::path runDir = folder / "run";
    const Plan small = planWithReference(folder, 256), large = planWithReference(folder, 512),
               less = planWithReference(folder, 100);
    const PlannedReference& wanted = large.references[0];
    const fs::path made = referenceFolder(wanted, runDir), cached = referenceCache() / wanted.key;
    REQUIRE(small.references[0].key == wanted.key);

    CHECK(runIn(folder, small).parts == 8);
    CHECK(cachedParts(wanted) == 8);
    const auto eight = contentOf(made);

    const auto extends = [&] {
        CHECK_FALSE(isReady(wanted, runDir));
        CHECK(runIn(folder, large).parts == 8);  // new ones
        CHECK(readReference(wanted, runDir).parts == 16);
        CHECK(cachedParts(wanted) == 16);
        return contentOf(made);
    };
    std::vector<std::string> extended;
    SECTION("in a run of its own") {
        fs::remove_all(runDir);
        extended = extends();
    }
    SECTION("in the run that had the smaller one") {
        fs::remove_all(referenceCache());
        extended = extends();
    }
    CHECK(extended != eight);
    CHECK(contentOf(cached) == extended);

    for (const Plan& plan : {less, small, large}) {
        fs::remove_all(runDir);
        CHECK(runIn(folder, plan).parts == 0);
        CHECK(contentOf(made) == extended);
        CHECK(contentOf(cached) == extended);
    }

    // Made at once it is the same, byte by byte.
    fs::remove_all(runDir);
    fs::remove_all(referenceCache());
    CHECK(runIn(folder, large).parts == 16);
    CHECK(contentOf(made) == extended);
}

TEST_CASE("a reference that took longer does not replace a better one", "[reference]") {
    const Folder folder;
    const Plan small = planWithReference(folder, 256), large = planWithReference(folder, 512);
    const PlannedReference& slow = small.references[0];
    CHECK_FALSE(prepareReference(slow, folder / "slow"));
    static const std::atomic<bool> never = false;
    for (int part = 0; part < 8; ++part)
        REQUIRE(renderReplicate(slow.task, part, partsFolder(slow, folder / "slow"), 1, never, {}));
    runIn(folder, large);
    finishReference(slow, folder / "slow");
    CHECK(readReference(slow, folder / "slow").parts == 8);
    CHECK(cachedParts(slow) == 16);
}

TEST_CASE("shares of features go on where they were", "[reference]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["scenes"] = {
        {"emitter", {{"type", "grid_of_holes"}, {"holes", 2}, {"back", "emitter"}, {"thickness", 0}}}};
    experiment["reference"]["part"]["spp"] = 8;
    const auto shares = [&](double spp) {
        experiment["reference"]["budget"]["spp"] = spp;
        const Plan plan = planOf(folder, experiment);
        runIn(folder, plan);
        const fs::path made = referenceFolder(plan.references[0], folder / "run");
        return JsonDocument::fromFile(made / "result.json").json().at("feature_shares");
    };
    const Json four = shares(32), eight = shares(64);
    REQUIRE(four.size() == 4);
    for (const auto& [name, share] : four.items()) CHECK(share.at("degrees") == 3);
    for (const auto& [name, share] : eight.items()) CHECK(share.at("degrees") == 7);
    fs::remove_all(folder / "run");
    fs::remove_all(referenceCache());
    CHECK(shares(64) == eight);
}

TEST_CASE("a reference by the type of sampler that it judges is told of", "[reference]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    const auto warnings = [&] { return sharedBiasWarnings(planOf(folder, experiment)); };
    CHECK(warnings() == std::vector<std::string>{"wall: the reference's sampler is of the same type, bdpt, as bdpt: a "
                                                 "bias that they share would not be seen"});
    // Parameters and names make no other type of it.
    experiment["samplers"] = {
        {"short", {{"type", "bdpt"}, {"rr_depth", 3}}}, {"other", {{"type", "bdpt"}}}, {"mlt", {{"type", "mlt"}}}};
    experiment["baseline"] = "mlt";
    experiment["sweep"] = {{"samplers.short.rr_depth", {2, 3}}};
    REQUIRE(warnings().size() == 1);
    CHECK(mentions(warnings()[0], "as other, short:"));

    experiment.erase("sweep");
    experiment["samplers"] = {{"mlt", {{"type", "mlt"}}}};
    for (const char* sampler : {"path", "bdpt"}) {
        experiment["reference"]["sampler"] = sampler;
        CHECK(warnings().empty());
    }
    writeTinyReference(folder);
    experiment["reference"] = "known.exr";
    CHECK(warnings().empty());
}

TEST_CASE("a reference knows the biases of its sampler, not those of the scene", "[reference]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    // Light tracing does not show what is seen in a mirror.
    experiment["scenes"]["wall"]["mirror"] = {{"type", "sphere"}, {"radius", 0.5}, {"bsdf", {{"type", "conductor"}}}};
    experiment["scenes"]["wall"]["$substitutions"] = Json::array({"a substitution"});
    const auto ledger = [&](const char* sampler) {
        experiment["reference"]["sampler"] = sampler;
        const Plan plan = planOf(folder, experiment);
        runIn(folder, plan);
        return readReference(plan.references[0], folder / "run").biasLedger;
    };
    CHECK(ledger("bdpt").empty());
    REQUIRE(ledger("light").size() == 1);
    CHECK(mentions(ledger("light")[0], "mirrors and glass"));
}

TEST_CASE("a file is a reference if its variance stands beside it", "[reference]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["reference"] = "known.exr";
    writeTinyReference(folder);
    const Plan plan = planOf(folder, experiment);
    REQUIRE(prepareReference(plan.references[0], folder / "run"));
    const Reference reference = readReference(plan.references[0], folder / "run");
    CHECK(reference.image.at(3, 3).x == 0.5f);
    CHECK(reference.variance.at(3, 3).x == 1e-4f);

    fs::remove(folder / "known.variance.exr");
    CHECK(errorOf([&] { planOf(folder, experiment); }).code == ExitCode::InputMissing);

    writeExr(folder / "known.variance.exr", Image(8, 8, Rgb(1)));
    const Plan wrong = planOf(folder, experiment);
    CHECK(mentions(errorOf([&] { prepareReference(wrong.references[0], folder / "run2"); }).message, "16 x 16"));

    writeExr(folder / "known.variance.exr", Image(16, 16, Rgb(-1e-6f)));
    const Plan negative = planOf(folder, experiment);
    const auto [code, message] = errorOf([&] { prepareReference(negative.references[0], folder / "run3"); });
    CHECK(code == ExitCode::InvalidConfig);
    CHECK(mentions(message, "known.variance.exr"));
}

TEST_CASE("a generator's truth has no variance, and knows the features' shares", "[reference]") {
    const Folder folder;
    Json experiment = fourHoles();
    const Plan plan = planOf(folder, experiment);
    REQUIRE(prepareReference(plan.references[0], folder / "run"));
    const Reference reference = readReference(plan.references[0], folder / "run");
    REQUIRE(reference.featureShares.size() == 4);
    CHECK(reference.featureShares[2].mean == Approx(0.25).epsilon(1e-3));
    CHECK(reference.variance.at(5, 5).x == 0);

    experiment["film"]["rfilter"] = {{"type", "gaussian"}};
    CHECK(mentions(errorOf([&] { planOf(folder, experiment); }).message, "box filter"));
}

TEST_CASE("a reference with pixels that have no sample is refused", "[reference]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["reference"] = {{"sampler", "bdpt"}, {"budget", {{"spp", 3.75}}}, {"part", {{"spp", 0.9375}}}};
    const Plan plan = planOf(folder, experiment);
    const auto [code, message] = errorOf([&] { runIn(folder, plan); });
    CHECK(code == ExitCode::InvalidConfig);
    CHECK(mentions(message, "16 pixels have no sample in part 1"));
    CHECK(mentions(message, "larger parts"));
}

TEST_CASE("a black reference is refused", "[reference]") {
    const Folder folder;
    Json experiment = tinyExperiment();
    experiment["scenes"]["wall"]["sensor"]["to_world"] = {
        {{"type", "lookat"}, {"origin", {0, 0, 4}}, {"target", {0, 0, 9}}, {"up", {0, 1, 0}}}};
    const Plan plan = planOf(folder, experiment);
    const auto [code, message] = errorOf([&] { runIn(folder, plan); });
    CHECK(code == ExitCode::InvalidConfig);
    CHECK(mentions(message, "no path carried light"));
}
