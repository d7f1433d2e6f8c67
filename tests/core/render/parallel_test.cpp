// Handing out work.

#include "core/render/parallel.h"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/path_scenes.h"

using namespace ulam;

TEST_CASE("every unit is done once, by the workers there are, in ranges that end at chunks") {
    for (const int workers : {1, 2, 3, 8}) {
        std::vector<std::atomic<int>> done(1000);
        std::atomic<bool> wrong = false;
        const uint64_t end = forEachChunk(
            workers, 13, 977, 64, [](int) { return false; },
            [&](int worker, uint64_t from, uint64_t to) {
                if (worker < 0 || worker >= workers || from >= to || (to % 64 != 0 && to != 977)) wrong = true;
                for (uint64_t i = from; i < to; ++i) ++done[i];
            });
        CHECK(end == 977);
        CHECK_FALSE(wrong);
        for (uint64_t i = 0; i < done.size(); ++i) REQUIRE(done[i] == (i >= 13 && i < 977));
    }
}

TEST_CASE("workers work at the same time, also while a scene lives") {
    // Embree limits the threads of others that share its task scheduler.
    const Scene scene = buildScene(pathScene("diffuse").dictionary);
    std::atomic<int> present = 0;
    std::atomic<bool> met = true;
    forEachChunk(
        3, 0, 3, 1, [](int) { return false; },
        [&](int, uint64_t, uint64_t) {
            ++present;
            const auto start = std::chrono::steady_clock::now();
            while (present < 3 && met)
                if (std::chrono::steady_clock::now() - start > std::chrono::seconds(20))
                    met = false;
                else
                    std::this_thread::yield();
        });
    CHECK(met);
}

TEST_CASE("a stop leaves everything before it done and nothing after") {
    std::vector<std::atomic<int>> done(100'000);
    std::atomic<int> asked = 0;
    const uint64_t end = forEachChunk(
        3, 0, done.size(), 10, [&](int) { return ++asked > 500; },
        [&](int, uint64_t from, uint64_t to) {
            for (uint64_t i = from; i < to; ++i) ++done[i];
        });
    CHECK(end > 0);
    CHECK(end < done.size());
    for (uint64_t i = 0; i < done.size(); ++i) REQUIRE(done[i] == (i < end));
}

TEST_CASE("an error of a worker reaches the caller") {
    for (const int workers : {1, 3})
        CHECK_THROWS_AS(forEachChunk(
                            workers, 0, 1000, 1, [](int) { return false; },
                            [](int, uint64_t from, uint64_t) {
                                if (from == 57) throw std::runtime_error("57");
                            }),
                        std::runtime_error);
}
