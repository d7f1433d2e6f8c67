// Hours of work in one process: scenes are loaded, rendered by every sampler and thrown away, again and again. Every
// repetition gives the bytes of the first, and memory does not grow.
//
//     ULAM_SOAK_MINUTES=60 build/release/tests/test_soak -s

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <chrono>
#include <fstream>
#include <map>
#include <numeric>
#include <random>

#include "core/render/driver.h"
#include "core/scene/generator.h"
#include "experiments/engine/result.h"
#include "tests/support/catch.h"
#include "tests/support/known_answers.h"
#include "tests/support/level.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

namespace {

constexpr double kMegabyte = 1 << 20;

/// What memory may grow by within so many hours. Pages are handed out in large pieces, so that their number goes in steps.
double allowedResident(double hours) { return 2 + 8 * hours; }
double allowedHeap(double hours) { return 0.1 + 0.4 * hours; }

struct Memory {
    double hours, residentMegabytes, heapMegabytes;
};

Memory measureMemory(double hours) {
    ::malloc_trim(0);  // what is free but not given back is no growth
    long total = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> total >> resident;
    const struct mallinfo2 heap = ::mallinfo2();
    return {hours, double(resident) * double(::sysconf(_SC_PAGESIZE)) / kMegabyte,
            double(heap.uordblks + heap.hblkhd) / kMegabyte};
}

/// Megabytes an hour: the least-squares slope, and the upper end of its 95 % interval. Of means over ten stretches of
/// time, because neighbouring values are much alike and do not count as independent.
struct Slope {
    double value, upper;
};

Slope slope(const std::vector<Memory>& rounds, double Memory::*quantity) {
    const std::size_t blocks = std::min<std::size_t>(10, rounds.size());
    std::vector<double> x, y;
    for (std::size_t b = 0; b < blocks; ++b) {
        const std::size_t begin = b * rounds.size() / blocks, end = (b + 1) * rounds.size() / blocks;
        double hours = 0, sum = 0;
        for (std::size_t i = begin; i < end; ++i) hours += rounds[i].hours, sum += rounds[i].*quantity;
        x.push_back(hours / double(end - begin));
        y.push_back(sum / double(end - begin));
    }
    const auto n = double(blocks);
    const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n, my = std::accumulate(y.begin(), y.end(), 0.0) / n;
    double sxx = 0, sxy = 0, residual = 0;
    for (std::size_t b = 0; b < blocks; ++b) sxx += (x[b] - mx) * (x[b] - mx), sxy += (x[b] - mx) * (y[b] - my);
    const double value = sxy / sxx;
    for (std::size_t b = 0; b < blocks; ++b) {
        const double r = y[b] - my - value * (x[b] - mx);
        residual += r * r;
    }
    const double t = boost::math::quantile(boost::math::students_t(n - 2), 0.975);
    return {value, value + t * std::sqrt(residual / (n - 2) / sxx)};
}

std::map<std::string, Json> soakScenes() {
    std::map<std::string, Json> scenes;
    for (const PathScene& scene : pathScenes()) scenes[scene.name] = scene.dictionary;
    for (const auto* entry : Registry<Generator>::instance().entries()) scenes[entry->name] = {{"type", entry->name}};
    scenes["terrain"]["cells"] = 50;
    return scenes;
}

/// The image's hash, or the error.
std::string outcome(const Scene& scene, const std::string& name) {
    Json dictionary = {{"type", name}, {"max_depth", 5}};
    if (isChainSampler(name)) dictionary["chains"] = 5, dictionary["bootstrap"] = 500;
    const auto sampler = Registry<Sampler>::instance().create(JsonNode(dictionary));
    RenderOptions options;
    options.budget.spp = 2;
    options.key = makeKey(23);
    try {
        return imageHash(render(scene, *sampler, options).image);
    } catch (const Error& error) {
        return error.what();
    }
}

double minutes() {
    if (const char* given = std::getenv("ULAM_SOAK_MINUTES")) return std::atof(given);
    return fullLevel() ? 1 : 0;
}

}  // namespace

TEST_CASE("growth is told from noise") {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.5);
    std::vector<Memory> steady, growing;
    for (int i = 0; i < 300; ++i) {
        const double hours = i / 300.0, resident = 100 + noise(random), heap = 20 + 0.01 * noise(random);
        steady.push_back({hours, resident, heap});
        growing.push_back({hours, resident + 11 * hours, heap + 0.6 * hours});
    }
    CHECK(slope(steady, &Memory::residentMegabytes).upper < allowedResident(1));
    CHECK(slope(steady, &Memory::heapMegabytes).upper < allowedHeap(1));
    CHECK(slope(growing, &Memory::residentMegabytes).value == Approx(11).margin(1));
    CHECK(slope(growing, &Memory::residentMegabytes).upper > allowedResident(1));
    CHECK(slope(growing, &Memory::heapMegabytes).upper > allowedHeap(1));
}

TEST_CASE("repetitions give the same bytes, and memory does not grow") {
    if (minutes() <= 0) return;  // not asked for
    const auto scenes = soakScenes();
    std::vector<std::pair<std::string, std::vector<std::string>>> order;
    for (const auto& [name, dictionary] : scenes) order.push_back({name, samplerNames()});

    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const auto hours = [&] { return std::chrono::duration<double>(Clock::now() - start).count() / 3600; };
    std::map<std::string, std::string> first;
    std::vector<Memory> rounds;
    rounds.reserve(1 << 16);
    std::mt19937 random(17);
    long renders = 0;
    constexpr std::size_t kWarmUp = 3, kLeast = 11;
    while (hours() * 60 < minutes() || rounds.size() < kLeast) {
        std::shuffle(order.begin(), order.end(), random);
        for (auto& [name, samplers] : order) {
            std::shuffle(samplers.begin(), samplers.end(), random);
            const Scene scene = buildScene(scenes.at(name), {{"width", 24}, {"height", 18}});
            for (const std::string& sampler : samplers) {
                const std::string result = outcome(scene, sampler);
                const auto [place, isNew] = first.try_emplace(name + " by " + sampler, result);
                INFO(place->first << ", repetition " << rounds.size());
                REQUIRE(result == place->second);
                ++renders;
            }
        }
        rounds.push_back(measureMemory(hours()));
    }

    // All are images, but of the sampler that needs openings, which says so in scenes that have none.
    for (const auto& [what, result] : first)
        if (result.find("needs a scene with features") == std::string::npos) CHECK(result.size() == 64);

    const std::size_t warmUp = std::max(kWarmUp, rounds.size() / 10);
    const std::vector<Memory> steady(rounds.begin() + std::ptrdiff_t(warmUp), rounds.end());
    const double time = steady.back().hours - steady.front().hours;
    const Slope resident = slope(steady, &Memory::residentMegabytes), heap = slope(steady, &Memory::heapMegabytes);
    const std::string figures = fmt::format(
        "{} scenes, {} combinations with samplers, {} renders in {} rounds, {:.1f} minutes\n"
        "after {} rounds of warm-up: resident {:.2f} to {:.2f} MB, slope {:.3f} MB an hour, at most {:.3f}\n"
        "heap in use {:.4f} to {:.4f} MB, slope {:.4f} MB an hour, at most {:.4f}",
        scenes.size(), first.size(), renders, rounds.size(), 60 * hours(), warmUp, steady.front().residentMegabytes,
        steady.back().residentMegabytes, resident.value, resident.upper, steady.front().heapMegabytes,
        steady.back().heapMegabytes, heap.value, heap.upper);
    INFO(figures);
    CHECK(resident.upper * time < allowedResident(time));
    CHECK(heap.upper * time < allowedHeap(time));
}
