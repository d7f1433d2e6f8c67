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

fs::path writeTinyReference(const Folder& folder) {
    Image image(16, 16, Rgb(0.5f)), variance(16, 16, Rgb(1e-4f));
    writeExr(folder / "known.exr", image);
    writeExr(folder / "known.variance.exr", variance);
    return folder / "known.exr";
}

}  // namespace

TEST_CASE("parts give a mean and its variance", "[reference]") {
    const CombinedParts combined = combineParts(noisyParts(0));
    double mean = 0, variance = 0;
    for (std::size_t i = 0; i < combined.image.pixels.size(); ++i) {
        mean += combined.image.pixels[i].x / double(combined.image.pixels.size());
        variance += combined.variance.pixels[i].x / double(combined.image.pixels.size());
    }
    // 512 pixels of the mean of 16 numbers of variance 1/12: standard errors 0.0032 and about 1.4e-4.
    CHECK(mean == Approx(1).margin(0.02));
    CHECK(variance == Approx(1.0 / 12 / 16).margin(7e-4));
}

TEST_CASE("halves that differ in one tile are found", "[reference]") {
    CHECK(combineParts(noisyParts(0)).smallestP() > kHalvesLevel);
    CHECK(combineParts(noisyParts(0.1)).smallestP() < kHalvesLevel);
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
    CHECK(key("reference.budget.spp", 512) != plain);
    CHECK(key("reference.replicates", 4) != plain);  // parts of twice the budget
    CHECK(key("scenes.wall.lamp.emitter.radiance", 3) != plain);
}

TEST_CASE("parts that are combined later come to the same", "[reference]") {
    const std::vector<Image> all = noisyParts(0.05), first(all.begin(), all.begin() + 6), rest(all.begin() + 6, all.end());
    const CombinedParts once = combineParts(all), twice = combineParts(rest, combineParts(first));
    CHECK(twice.parts == once.parts);
    for (std::size_t i = 0; i < once.image.pixels.size(); ++i) {
        CHECK(twice.image.pixels[i].x == Approx(once.image.pixels[i].x));
        CHECK(twice.variance.pixels[i].x == Approx(once.variance.pixels[i].x).epsilon(1e-4));
    }
    CHECK(twice.smallestP() == Approx(once.smallestP()));
    const JsonDocument stored = JsonDocument::fromText(halvesJson(twice).dump(), "halves");
    CombinedParts read = twice;
    read.halves = halvesFromJson(stored.root());
    CHECK(read.smallestP() == twice.smallestP());
}

TEST_CASE("a reference is extended by the parts that are new", "[reference]") {
    const Folder folder;
    const Plan plan = planOf(folder, tinyExperiment());
    runIn(folder, plan);
    Json larger = tinyExperiment();
    larger["reference"] = {{"sampler", "bdpt"}, {"budget", {{"spp", 512}}}, {"replicates", 16}};
    const Plan more = planOf(folder, larger);
    const PlannedReference &before = plan.references[0], &after = more.references[0];
    REQUIRE(after.key == before.key);
    CHECK(cachedParts(after) == 8);

    CHECK_FALSE(prepareReference(after, folder / "other"));
    CHECK(readyParts(after, folder / "other") == 8);
    // Parts that are there are not made again, whatever has become of them: these numbers are theirs.
    for (int part = 8; part < 16; ++part) {
        static const std::atomic<bool> never = false;
        REQUIRE(renderReplicate(after.task, part, partsFolder(after, folder / "other"), 1, never, {}));
    }
    finishReference(after, folder / "other");
    const Reference extended = readReference(after, folder / "other");
    CHECK(extended.parts == 16);
    CHECK(cachedParts(after) == 16);

    // As if it had been made at once.
    fs::remove_all(referenceCache());
    runIn(folder, more);
    const Reference whole = readReference(after, folder / "run");
    CHECK(whole.parts == 16);
    for (std::size_t i = 0; i < whole.image.pixels.size(); ++i) {
        CHECK(extended.image.pixels[i].x == Approx(whole.image.pixels[i].x));
        CHECK(extended.variance.pixels[i].x == Approx(whole.variance.pixels[i].x).epsilon(1e-4));
    }

    // Whoever asks for fewer gets the better one.
    CHECK(prepareReference(before, folder / "third"));
    CHECK(readReference(before, folder / "third").parts == 16);
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
    Json experiment = tinyExperiment();
    experiment["scenes"] = {
        {"emitter", {{"type", "grid_of_holes"}, {"holes", 2}, {"back", "emitter"}, {"thickness", 0}}}};
    experiment["film"]["rfilter"] = {{"type", "box"}};
    experiment["reference"] = "truth";
    experiment["max_depth"] = 2;
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
    experiment["reference"] = {{"sampler", "bdpt"}, {"budget", {{"spp", 3.75}}}, {"replicates", 4}};
    const Plan plan = planOf(folder, experiment);
    const auto [code, message] = errorOf([&] { runIn(folder, plan); });
    CHECK(code == ExitCode::InvalidConfig);
    CHECK(mentions(message, "16 pixels have no sample in part 1"));
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
