#include "experiments/report/replicate_maps.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/image/image_io.h"
#include "experiments/statistics/philox_stream.h"
#include "tests/support/catch.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

constexpr double kExact = std::numeric_limits<double>::infinity();

/// Replicates on disk, gone at the end.
struct Replicates {
    Replicates() : folder(fs::temp_directory_path() / ("ulam_maps_test_" + std::to_string(std::random_device{}()))) {
        fs::create_directories(folder);
    }
    ~Replicates() { fs::remove_all(folder); }

    void add(const Image& image) {
        files.push_back(folder / (std::to_string(files.size()) + ".exr"));
        writeExr(files.back().string(), image);
    }

    /// Grey pixels of expectation 1, or `value` where x is below `width`, with gamma noise of a relative deviation.
    void addNoisy(int size, double deviation, statistics::PhiloxStream& random, int width = 0, double value = 1) {
        const double shape = 1 / (deviation * deviation);
        std::gamma_distribution<double> noise(shape, 1 / shape);
        Image image(size, size);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) image.at(x, y) = Rgb(float(noise(random) * (x < width ? value : 1)));
        add(image);
    }

    fs::path folder;
    std::vector<fs::path> files;
};

MapReference exactReference(int size) {
    return {Image(size, size, Rgb(1)), Image(size, size), kExact};
}

int countDifferent(const ByteMap& map) {
    int different = 0;  // p ≤ 0.05 is 26 steps of 10^(1/20) below 1
    for (const std::uint8_t byte : map.bytes) different += byte != 0 && std::abs(int(byte) - 128) >= 26;
    return different;
}

}  // namespace

TEST_CASE("the map of deviations holds the relative standard deviation of each block") {
    Replicates replicates;
    for (const float value : {1.0f, 2.0f, 3.0f}) {
        Image image(3, 2, Rgb(1));
        image.at(0, 0) = Rgb(value);
        replicates.add(image);
    }
    const ByteMap map = mapReplicates(replicates.files, nullptr, 1).deviation;
    REQUIRE(map.bytes.size() == 6);
    const double expected = 1 / std::sqrt(4 + 0.01);
    CHECK(std::pow(10, 6 * (map.bytes[0] - 1) / 254.0 - 3) == Approx(expected).epsilon(0.03));
    CHECK(map.bytes[1] == 0);
    const ReplicateMaps halved = mapReplicates(replicates.files, nullptr, 2);
    CHECK(halved.deviation.width == 2);
    CHECK(halved.deviation.height == 1);
    CHECK(halved.mean.at(0, 0).x == Approx(2));
    CHECK_FALSE(halved.tests);
}

TEST_CASE("a right sampler's map has a false discovery in at most 5 % of experiments") {
    statistics::PhiloxStream random(41);
    int alarms = 0;
    constexpr int kExperiments = 200;
    for (int i = 0; i < kExperiments; ++i) {
        Replicates replicates;
        for (int r = 0; r < 8; ++r) replicates.addNoisy(16, 0.3, random);
        const MapReference reference = exactReference(16);
        const ReplicateMaps maps = mapReplicates(replicates.files, &reference, 1);
        REQUIRE(maps.tests);
        alarms += countDifferent(*maps.tests) > 0;
    }
    CHECK(alarms <= 0.05 * kExperiments + 2 * std::sqrt(0.05 * kExperiments));
}

TEST_CASE("a bias of 30 % is found where it is, with its sign") {
    statistics::PhiloxStream random(42);
    for (const double value : {0.7, 1.3}) {
        Replicates replicates;
        for (int r = 0; r < 16; ++r) replicates.addNoisy(32, 0.1, random, 8, value);
        const MapReference reference = exactReference(32);
        const ReplicateMaps maps = mapReplicates(replicates.files, &reference, 1);
        REQUIRE(maps.tests->block == 1);
        int found = 0, elsewhere = 0;
        for (int i = 0; i < 32 * 32; ++i) {
            const int size = int(maps.tests->bytes[std::size_t(i)]) - 128;
            if (std::abs(size) < 26) continue;
            const bool biased = i % 32 < 8 && (size > 0) == (value > 1);
            ++(biased ? found : elsewhere);
        }
        CHECK(found >= 250);     // of 256
        CHECK(elsewhere <= 30);  // 5 % of the discoveries are expected to be false
    }
}

TEST_CASE("blocks grow until most can be judged, and a reference's variance counts") {
    statistics::PhiloxStream random(43);
    Replicates replicates;
    // At 16 replicates a block is judged up to a relative deviation of 1/2: blocks of 4 x 4 pixels.
    for (int r = 0; r < 16; ++r) replicates.addNoisy(32, 1.5, random, 32, 1.5);
    MapReference reference = exactReference(32);
    const ReplicateMaps maps = mapReplicates(replicates.files, &reference, 1);
    CHECK(maps.tests->block == 4);
    CHECK(maps.tests->width == 8);
    CHECK(countDifferent(*maps.tests) > 48);
    reference.variance = Image(32, 32, Rgb(1));
    const ReplicateMaps unsure = mapReplicates(replicates.files, &reference, 1);
    CHECK(countDifferent(*unsure.tests) == 0);
}

TEST_CASE("what never varies is not judged") {
    Replicates replicates;
    for (int r = 0; r < 4; ++r) replicates.add(Image(4, 4, Rgb(2)));
    const MapReference reference = exactReference(4);
    const ReplicateMaps maps = mapReplicates(replicates.files, &reference, 1);
    for (const std::uint8_t byte : maps.tests->bytes) CHECK(byte == 0);
}

TEST_CASE("replicates of different sizes are refused by name") {
    Replicates replicates;
    replicates.add(Image(4, 4, Rgb(1)));
    replicates.add(Image(4, 5, Rgb(1)));
    try {
        mapReplicates(replicates.files, nullptr, 1);
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::InvalidConfig);
        CHECK(std::string(error.what()).find("1.exr: expected 4 x 4 pixels") != std::string::npos);
    }
}
