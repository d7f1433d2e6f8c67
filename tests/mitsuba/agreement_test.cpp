// Scenes rendered by Mitsuba 3 look as they do here. scenes/*.json: a scene, and optionally max_depth and samplers; scenes of
// every BSDF under every kind of light (matrix.h); public scenes in Mitsuba's own XML. Tiles and total energy are judged as in the audit of images (experiments/verify): Holm at 1e-5 over all
// tiles and channels of all scenes and samplers of a run, 99.999 % intervals of the energy. Fixed seeds.

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <regex>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/scene/export/mitsuba.h"
#include "experiments/verify/work.h"
#include "tests/experiments/statistics/simulation.h"
#include "tests/mitsuba/matrix.h"
#include "tests/support/catch.h"
#include "tests/support/level.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

const fs::path kHere = "tests/mitsuba", kBuild = "build/mitsuba", kPython = "build/python/bin/python";

constexpr int kRuns = 32, kThreads = 2;
// Largest half width of the energy interval: 0.3 % with tests/run --full, else 1.5 % by a twenty-fifth of the work.
const double kEnergyWidth = fullLevel() ? 0.003 : 0.015;
// Largest standard error of the energies' difference: the interval's half width is at most 5.3 of them (Student's t at
// 31 degrees of freedom).
const double kLargestError = kEnergyWidth / 5.3;
// Aims are below limits by this factor, since variances are known from pilots of 32 runs.
constexpr double kReserve = 1.2;
/// Sums in single precision: where an image has no variance, its last digits are no difference.
constexpr double kRounding = 1e-6;

struct TestScene {
    int maxDepth = 5;
    Json samplers{"path", "bdpt", "pssmlt", "mlt"};
    JsonNode scene;
    std::string name;
    /// Mitsuba's part of the square of kLargestError. Its images serve all samplers.
    double mitsubaShare = 1.0 / 3;
    bool delta = false;  ///< both renderers miss what specular surfaces make of lights without extent
    fs::path xml;        ///< Mitsuba's own file, instead of `scene`

    template <class V>
    void describe(V& v) {
        v("max_depth", maxDepth, {.help = "longest path in edges", .min = 1});
        v("samplers", samplers, {.help = "by name, those that find all light of the scene"});
        v("scene", scene, {.help = "dictionary; its film's sides are multiples of 8 pixels"});
    }
};

/// Scenes by others, in Mitsuba's XML, with a small film and a filter that does not reach beyond the film's border.
std::vector<TestScene> publicScenes() {
    std::vector<TestScene> scenes;
    for (const std::string name : {"cornell-box", "veach-bidir"}) {
        const fs::path original = fs::path("../shared/scenes") / name, copy = kBuild / "public" / name;
        if (!fs::exists(original)) {
            std::cout << "the public scene " << name << " is not compared: there is no " << original.string() << "\n";
            continue;
        }
        fs::remove_all(copy);
        fs::create_directories(copy);
        fs::copy(original, copy, fs::copy_options::recursive);
        fs::permissions(copy / "scene.xml", fs::perms::owner_write, fs::perm_options::add);
        std::string text = readFile(copy / "scene.xml");
        const auto replace = [&](const char* pattern, const char* by) { text = std::regex_replace(text, std::regex(pattern), by); };
        replace("(name=\"res[xy]\" value=)\"[0-9]+", "$1\"32");
        replace("value=\"path_guiding_integrator\"", "value=\"path\"");
        replace("<rfilter type=\"[a-z]+\"", "<rfilter type=\"box\"");
        std::ofstream(copy / "scene.xml") << text;
        scenes.emplace_back();
        // Directly lit alone: the rest of veach-bidir's light Mitsuba's path tracer hardly finds, which takes it a quarter of
        // an hour to a standard error of 0.1 %.
        scenes.back().maxDepth = name == "veach-bidir" ? 2 : 6;
        scenes.back().samplers = Json::array({"bdpt"});
        scenes.back().mitsubaShare = 0.8;  // it takes ten times as long as bdpt here
        scenes.back().name = name;
        scenes.back().xml = copy / "scene.xml";
    }
    return scenes;
}

std::vector<TestScene> testScenes() {
    std::vector<TestScene> scenes;
    for (const auto& entry : fs::directory_iterator(kHere / "scenes")) {
        if (entry.path().extension() != ".json") continue;
        scenes.push_back(parseParameters<TestScene>(JsonDocument::fromFile(entry.path()).root()));
        scenes.back().name = entry.path().stem();
    }
    std::ranges::sort(scenes, {}, &TestScene::name);
    for (TestScene& scene : publicScenes()) scenes.push_back(std::move(scene));
    for (MatrixScene& matrix : matrixScenes()) {
        scenes.emplace_back();
        scenes.back().maxDepth = 4;
        scenes.back().samplers = std::move(matrix.samplers);
        scenes.back().scene = JsonNode(std::move(matrix.scene));
        scenes.back().name = matrix.name;
        scenes.back().delta = matrix.name.starts_with("matrix point");
    }
    return scenes;
}

/// Names and bytes of all files below a folder, in the order of their names.
std::string contentOf(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files[entry.path()] = readFile(entry.path());
    std::string content;
    for (const auto& [name, bytes] : files) content += fmt::format("{}\n{}\n{}", name, bytes.size(), bytes);
    return content;
}

/// Mitsuba's images of an exported scene: kept by what they depend on, or rendered.
std::string mitsubaRuns(const fs::path& folder, const TestScene& test) {
    const std::string options = fmt::format("max_depth={} runs={} error={}", test.maxDepth, kRuns,
                                            kLargestError * std::sqrt(test.mitsubaShare) / kReserve);
    const std::string key =
        sha256(contentOf(folder) + options + readFile(kHere / "render.py") + readFile("tests/requirements.txt"));
    const fs::path images = kBuild / "renders" / (key + ".f32");
    fs::create_directories(images.parent_path());
    if (!fs::exists(images)) {
        const std::string command = fmt::format("{} {} \"{}\" {} {}", kPython.string(), (kHere / "render.py").string(),
                                                (folder / "scene.xml").string(), images.string(), options);
        INFO(command);
        std::fflush(stdout);
        REQUIRE(std::system(command.c_str()) == 0);
    }
    return readFile(images);
}

verify::TiledEstimate mitsubaEstimate(const TestScene& test, const SceneDescription& description) {
    const fs::path folder = test.xml.empty() ? kBuild / "scenes" / test.name : test.xml.parent_path();
    if (test.xml.empty()) {
        const std::vector<std::string> leftOut = exportMitsuba3(description, folder);
        CAPTURE(leftOut);
        CHECK(leftOut.empty());
    }
    const std::string bytes = mitsubaRuns(folder, test);
    const FilmSize size = description.filmSize();
    Image image(size.cropWidth, size.cropHeight);
    const size_t imageBytes = image.pixels.size() * sizeof(Rgb);
    REQUIRE(bytes.size() == imageBytes * kRuns);
    verify::TiledRuns runs;
    for (size_t r = 0; r < kRuns; ++r) {
        std::memcpy(&image.pixels[0].x, bytes.data() + r * imageBytes, imageBytes);
        runs.add(image);
    }
    verify::TiledEstimate estimate = runs.estimate();
    for (auto& tile : estimate.tiles) tile.varianceOfMean += std::pow(kRounding * tile.mean, 2);
    return estimate;
}

double relativeError(const statistics::MeanEstimate& estimate) {
    return std::sqrt(estimate.varianceOfMean) / estimate.mean;
}

/// With as much work as it takes for the difference to Mitsuba's energy to be sharp: a pilot says how much. The images
/// of a pilot, or of a run that it sized too small, are not used.
verify::TiledEstimate ownEstimate(const TestScene& test, const Scene& scene, const std::string& sampler,
                                  double mitsubaError) {
    const double limit = std::sqrt(std::pow(kLargestError, 2) - std::pow(mitsubaError, 2));
    REQUIRE(limit > 0);
    const bool chains = Registry<Sampler>::instance().create(JsonNode(Json{{"type", sampler}}))->isChainSampler();
    double work = chains ? 10'000 : 8;
    for (int attempt = 0;; ++attempt) {
        Json config = {{"type", sampler}, {"max_depth", test.maxDepth}};
        Budget budget;
        (chains ? budget.mutations : budget.spp) = std::ceil(work);
        if (chains) config["bootstrap"] = std::llround(work);
        const uint64_t cell = verify::cellOf(fmt::format("{} {} {}", test.name, sampler, attempt));
        verify::TiledEstimate estimate = verify::renderTiled(scene, config, budget, kRuns, 1, cell, kThreads);
        const double error = relativeError(estimate.energy);
        if (attempt > 0 && error <= limit) return estimate;
        work *= std::max(1.0, std::pow(kReserve * error / limit, 2));
    }
}

class StopWatch {
public:
    /// Seconds since the last call.
    double lap() {
        const auto last = std::exchange(last_, std::chrono::steady_clock::now());
        return std::chrono::duration<double>(last_ - last).count();
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

verify::Finding judge(const std::vector<verify::ImageComparison>& comparisons) {
    verify::Work work{};
    work.runs = kRuns;
    work.energyWidth = kEnergyWidth;
    return verify::judgeImages(comparisons, work);
}

}  // namespace

TEST_CASE("agreement: Mitsuba 3 renders exported scenes alike") {
    if (!fs::exists(kPython)) {
        // ctest takes this line for the sign of a test that was skipped.
        std::cout << "not compared with Mitsuba 3: there is no " << kPython.string() << ", which tests/run makes\n";
        return;
    }
    std::vector<verify::ImageComparison> comparisons;
    for (const TestScene& test : testScenes()) {
        const auto description = test.xml.empty() ? SceneDescription::fromNode(test.scene, kHere / "scenes") : SceneDescription::fromFile(test.xml);
        const Scene scene = description.build();
        StopWatch watch;
        const verify::TiledEstimate reference = mitsubaEstimate(test, description);
        fmt::print("{}: mean {:.5f}, {:.1f} s\n", test.name, reference.energy.mean, watch.lap());
        for (const std::string sampler : test.samplers) {
            const verify::TiledEstimate own = ownEstimate(test, scene, sampler, relativeError(reference.energy));
            INFO(test.name << " by " << sampler);
            CHECK(own.biasLedger.empty() == !test.delta);
            comparisons.push_back(compare(fmt::format("{} by {}", test.name, sampler), own, reference));
            const auto& c = comparisons.back();
            fmt::print("    {:<8} energy {:+.3f} % (± {:.3f} %), smallest p {:.2g} of {}, {:.1f} s\n", sampler,
                       100 * c.energyShift, 100 * c.energyWidth, *std::ranges::min_element(c.p), c.p.size(),
                       watch.lap());
        }
    }
    const verify::Finding finding = judge(comparisons);
    fmt::print("{}\n", finding.summary);
    CAPTURE(finding.details);
    CHECK(finding.outcome == verify::Outcome::Passed);
}

TEST_CASE("agreement: whatever the noise, an energy that is off by 5/3 of the largest width does not pass") {
    const auto passes = [](double noise, double shift) {
        return statistics::simulation::frequency(400, 1, [&](statistics::PhiloxStream& random) {
            const auto runs = [&](double mean) {
                verify::TiledRuns tiled;
                for (const double x : statistics::simulation::normals(kRuns, random))
                    tiled.add(Image(8, 8, Rgb(float(mean * (1 + x * noise * std::sqrt(kRuns / 2.0))))));
                return tiled.estimate();
            };
            return judge({compare("made up", runs(1 + shift), runs(1))}).outcome == verify::Outcome::Passed;
        });
    };
    for (const double noise : {0.3, 0.6, 0.8, 1.0, 1.2, 2.0}) {
        CAPTURE(noise);
        CHECK(passes(noise * kLargestError, kEnergyWidth * 5 / 3) < 0.01);
        CHECK(passes(noise * kLargestError, -kEnergyWidth * 5 / 3) < 0.01);
    }
    CHECK(passes(0.8 * kLargestError, 0) > 0.99);
}
