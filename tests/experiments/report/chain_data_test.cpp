#include "experiments/report/chain_data.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/catch.h"

using namespace ulam;
namespace fs = std::filesystem;

namespace {

using Draw = std::array<float, 5>;

struct Folder {
    Folder() : path(fs::temp_directory_path() / ("ulam_chains_test_" + std::to_string(std::random_device{}()))) {
        fs::create_directories(path);
    }
    ~Folder() { fs::remove_all(path); }
    fs::path path;
};

/// An image of 100 x 50 pixels and a file of chains beside it.
Json writeChains(const fs::path& folder, int chains, int draws, const std::vector<Draw>& values) {
    const std::string header(118, ' ');
    std::string bytes = std::string("\x93NUMPY\x01\x00", 8) + char(118) + '\0' + header;
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Draw));
    writeFileAtomically(folder / "chains.npy", bytes);
    return {{"width", 100}, {"height", 50}, {"traces", {{"file", "chains.npy"}, {"chains", chains}, {"draws", draws}}}};
}

int word(const std::string& bytes, std::size_t i) {
    return int(static_cast<unsigned char>(bytes[2 * i])) + 256 * int(static_cast<unsigned char>(bytes[2 * i + 1]));
}

}  // namespace

TEST_CASE("chains are embedded scalar by scalar, as fractions and small numbers") {
    Folder folder;
    const Json result = writeChains(
        folder.path, 2, 2, {{0, 0, -4, 2, -1}, {100, 50, 4, 3, 0}, {50, 25, 0, 300, 7}, {25, 60, -INFINITY, 4, 2}});
    const auto data = readChainData(folder.path, result, 64);
    REQUIRE(data);
    REQUIRE(data->bytes.size() == 4 * kDrawBytes);
    CHECK(data->fields["chains"] == 2);
    CHECK(data->fields["draws"] == 2);
    CHECK(data->fields["log_target"] == Json({-4, 4}));
    const int across[] = {0, 65535, 32768, 16384}, down[] = {0, 65535, 32768, 65535}, target[] = {0, 65535, 32768, 0};
    const int length[] = {2, 3, 255, 4}, feature[] = {0, 1, 8, 3};
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(word(data->bytes, i) == across[i]);
        CHECK(word(data->bytes, 4 + i) == down[i]);
        CHECK(word(data->bytes, 8 + i) == target[i]);
        CHECK(int(static_cast<unsigned char>(data->bytes[24 + i])) == length[i]);
        CHECK(int(static_cast<unsigned char>(data->bytes[28 + i])) == feature[i]);
    }
}

TEST_CASE("of too many chains some are kept, evenly spaced") {
    Folder folder;
    std::vector<Draw> values;
    for (int chain = 0; chain < 10; ++chain) values.push_back({0, 0, 1, float(chain), -1});
    const auto data = readChainData(folder.path, writeChains(folder.path, 10, 1, values), 4);
    REQUIRE(data);
    CHECK(data->fields["chains"] == 4);
    const std::size_t lengths = 4 * 6;
    const int kept[] = {0, 2, 5, 7};
    for (std::size_t i = 0; i < 4; ++i) CHECK(data->bytes[lengths + i] == char(kept[i]));
}

TEST_CASE("without chains there are none, and a damaged file is named") {
    Folder folder;
    CHECK_FALSE(readChainData(folder.path, {{"traces", nullptr}}, 64));
    CHECK_FALSE(readChainData(folder.path, Json::object(), 64));
    Json result = writeChains(folder.path, 2, 1, {{0, 0, 0, 2, -1}, {0, 0, 0, 2, -1}});
    CHECK_FALSE(readChainData(folder.path, result, 0));
    result["traces"]["draws"] = 3;
    try {
        readChainData(folder.path, result, 64);
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::InvalidConfig);
        CHECK(std::string(error.what()).find("chains.npy: expected a NumPy file of 30") != std::string::npos);
    }
    fs::remove(folder.path / "chains.npy");
    CHECK_FALSE(readChainData(folder.path, result, 64));
}
