#include "experiments/report/chain_maps.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/json.h"
#include "core/image/image_io.h"
#include "experiments/statistics/philox_stream.h"
#include "tests/support/catch.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

constexpr int kSize = 32;

/// Replicates of chains on disk, gone at the end. The left quarter of a run's image may be what it found at the start.
struct Runs {
    Runs() : folder(fs::temp_directory_path() / ("ulam_chain_maps_test_" + std::to_string(std::random_device{}()))) {}
    ~Runs() { fs::remove_all(folder); }

    /// Noise of a deviation that falls with the root of the steps, about an expectation of `normalization`.
    void add(statistics::PhiloxStream& random, double stuck, double firstShare, double normalization = 1) {
        std::normal_distribution<double> normal;
        const double steps = 1e6, first = firstShare * steps;
        Image half(kSize, kSize), whole(kSize, kSize);
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const double found = x < kSize / 4 ? 1 + stuck * normal(random) : 1;
                const double early = found + 100 * normal(random) / std::sqrt(first);
                const double late = found + 100 * normal(random) / std::sqrt(steps - first);
                half.at(x, y) = Rgb(float(normalization * early));
                whole.at(x, y) = Rgb(float(normalization * (firstShare * early + (1 - firstShare) * late)));
            }
        Json result = {{"mutations", steps}, {"normalization", normalization}};
        result["snapshots"] = Json::array({{{"mutations", first}, {"image", "snapshots/s00.exr"}}});
        write(half, whole, result);
    }
    void write(const Image& half, const Image& whole, const Json& result) {
        folders.push_back(folder / std::to_string(folders.size()));
        fs::create_directories(folders.back() / "snapshots");
        writeExr((folders.back() / "image.exr").string(), whole);
        writeExr((folders.back() / "snapshots/s00.exr").string(), half);
        writeFileAtomically(folders.back() / "result.json", result.dump());
    }
    void count(std::size_t run, const Image& proposed, const Image& accepted) {
        fs::create_directories(folders[run] / "extra");
        writeExr((folders[run] / "extra/proposed.exr").string(), proposed);
        writeExr((folders[run] / "extra/accepted.exr").string(), accepted);
    }

    fs::path folder;
    std::vector<fs::path> folders;
};

double rhat(std::uint8_t byte) {
    return std::exp2((byte - 1) / 64.0 - 1);
}

/// Of the blocks of the left quarter, or of the others.
std::vector<double> rhats(const ByteMap& map, bool left) {
    std::vector<double> values;
    for (int i = 0; i < map.width * map.height; ++i)
        if ((i % map.width < map.width / 4) == left) values.push_back(rhat(map.bytes[std::size_t(i)]));
    return values;
}

double meanOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double x : values) sum += x / double(values.size());
    return sum;
}

}  // namespace

TEST_CASE("R-hat is near 1 where runs mix, whatever the share of the first half and the scale of a run", "[chain_maps]") {
    statistics::PhiloxStream random(51);
    for (const double share : {0.5, 0.3}) {
        Runs runs;
        for (int r = 0; r < 8; ++r) runs.add(random, 0, share, r % 2 ? 1 : 3);
        const std::optional<ByteMap> map = mapRhat(runs.folders, 1);
        REQUIRE(map);
        CHECK(map->block == kRhatBlock);
        REQUIRE(map->width == kSize / kRhatBlock);
        const std::vector<double> values = rhats(*map, false);
        // Per block 112 and 128 degrees of freedom: a standard deviation of 0.046.
        CHECK(meanOf(values) == Approx(1).margin(5 * 0.046 / std::sqrt(double(values.size()))));
        CHECK(*std::ranges::min_element(values) > 1 - 5 * 0.046);
        CHECK(*std::ranges::max_element(values) < 1 + 5 * 0.046);
    }
}

TEST_CASE("R-hat is large where each run stays with what it found", "[chain_maps]") {
    statistics::PhiloxStream random(52);
    Runs runs;
    // Runs vary by 0.1 + 0.5 as deviations: R-hat = √((1 + 26) / 2).
    for (int r = 0; r < 8; ++r) runs.add(random, 0.5, 0.5);
    const std::optional<ByteMap> map = mapRhat(runs.folders, 1);
    REQUIRE(map);
    CHECK(meanOf(rhats(*map, true)) == Approx(std::sqrt(13.5)).epsilon(0.15));
    CHECK(meanOf(rhats(*map, false)) == Approx(1).margin(0.05));
}

TEST_CASE("R-hat needs two runs with halves, and says nothing of what never varies", "[chain_maps]") {
    statistics::PhiloxStream random(53);
    Runs runs;
    runs.add(random, 0, 0.5);
    CHECK_FALSE(mapRhat(runs.folders, 1));
    runs.write(Image(kSize, kSize, Rgb(1)), Image(kSize, kSize, Rgb(1)), {{"mutations", 100}, {"normalization", 1}});
    CHECK_FALSE(mapRhat(runs.folders, 1));
    Runs same;
    Json result = {{"mutations", 100}, {"normalization", 1}};
    result["snapshots"] = Json::array({{{"mutations", 50}, {"image", "snapshots/s00.exr"}}});
    for (int r = 0; r < 3; ++r) same.write(Image(8, 6, Rgb(2)), Image(8, 6, Rgb(2)), result);
    const std::optional<ByteMap> map = mapRhat(same.folders, 1);
    REQUIRE(map);
    CHECK(map->bytes == std::vector<std::uint8_t>{0, 0, 0, 0});
    same.write(Image(6, 8, Rgb(2)), Image(6, 8, Rgb(2)), result);
    CHECK_THROWS_AS(mapRhat(same.folders, 1), Error);
}

TEST_CASE("acceptance is over all runs together", "[chain_maps]") {
    Runs runs;
    const Json nothing = Json::object();
    for (int r = 0; r < 3; ++r) runs.write(Image(2, 1), Image(2, 1), nothing);
    CHECK_FALSE(mapAcceptance(runs.folders, 1));
    Image proposed(2, 1), accepted(2, 1);
    proposed.at(0, 0) = Rgb(300), accepted.at(0, 0) = Rgb(150);
    runs.count(0, proposed, accepted);
    proposed.at(0, 0) = Rgb(100), accepted.at(0, 0) = Rgb(0);
    runs.count(2, proposed, accepted);
    const std::optional<ByteMap> map = mapAcceptance(runs.folders, 1);
    REQUIRE(map);
    CHECK((map->bytes[0] - 1) / 254.0 == Approx(0.375).margin(0.002));
    CHECK(map->bytes[1] == 0);
}
