#include "experiments/engine/lease.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/experiments/engine/tiny.h"
#include "tests/support/catch.h"

using namespace ulam;
using namespace ulam::tests;
namespace fs = std::filesystem;

namespace {

/// The lease of a process of another host, renewed `age` seconds ago.
fs::path putLease(const fs::path& folder, int number, double age, double seconds = 60) {
    const fs::path file = folder / fmt::format("lease-{}", number);
    writeFileAtomically(file,
                        Json{{"host", "elsewhere"}, {"process", 1}, {"since", "then"}, {"seconds", seconds}}.dump());
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::milliseconds(std::int64_t(1000 * age)));
    return file;
}

std::size_t filesIn(const fs::path& folder) {
    return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("a lease is one process's until it is released", "[lease]") {
    const Folder folder;
    CHECK_FALSE(leaseHolder(folder.path));
    {
        const auto lease = Lease::claim(folder.path);
        REQUIRE(lease);
        CHECK(lease->number() == 1);
        CHECK_FALSE(Lease::claim(folder.path));
        const auto holder = leaseHolder(folder.path);
        REQUIRE(holder);
        CHECK(holder->host == hostName());
        CHECK(holder->process == ::getpid());
        CHECK_FALSE(holder->expired);
    }
    CHECK(filesIn(folder.path) == 0);
    CHECK(Lease::claim(folder.path)->number() == 1);
}

TEST_CASE("a lease that is not renewed expires and is taken over", "[lease]") {
    const Folder folder;
    putLease(folder.path, 3, 59);
    CHECK_FALSE(Lease::claim(folder.path));
    CHECK_FALSE(leaseHolder(folder.path)->expired);
    putLease(folder.path, 3, 61);
    CHECK(leaseHolder(folder.path)->expired);
    const auto lease = Lease::claim(folder.path);
    REQUIRE(lease);
    CHECK(lease->number() == 4);
    CHECK(filesIn(folder.path) == 1);
    // One that can be claimed beside a valid one of a smaller number is none.
    putLease(folder.path, 2, 0);
    CHECK(leaseHolder(folder.path)->number == 4);
}

TEST_CASE("who made a lease and did not come to say so is somebody", "[lease]") {
    const Folder folder;
    for (const char* text : {"", "{\"host\": 3}", "[]"}) {
        writeFileAtomically(folder / "lease-1", text);
        CHECK_FALSE(leaseHolder(folder.path)->expired);
        CHECK_FALSE(Lease::claim(folder.path));
    }
    fs::last_write_time(folder / "lease-1", fs::file_time_type::clock::now() - std::chrono::hours(1));
    CHECK(Lease::claim(folder.path));
}

TEST_CASE("a lease of a process of this host that has ended has expired", "[lease]") {
    const Folder folder;
    writeFileAtomically(folder / "lease-1",
                        Json{{"host", hostName()}, {"process", 99'999'999}, {"seconds", 60}}.dump());
    CHECK(leaseHolder(folder.path)->expired);
    writeFileAtomically(folder / "lease-1",
                        Json{{"host", hostName()}, {"process", ::getppid()}, {"seconds", 60}}.dump());
    CHECK_FALSE(leaseHolder(folder.path)->expired);
}

TEST_CASE("a lease is renewed while it is held", "[lease]") {
    const Folder folder;
    const auto lease = Lease::claim(folder.path, 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    CHECK_FALSE(leaseHolder(folder.path)->expired);
    CHECK_FALSE(Lease::claim(folder.path));
}

TEST_CASE("one of many takes over an expired lease", "[lease]") {
    const Folder folder;
    int taken = 0;
    for (int turn = 0; turn < 100; ++turn) {
        const fs::path place = folder / std::to_string(turn);
        fs::create_directories(place);
        putLease(place, 1, 100);
        std::atomic<int> holders = 0;
        std::atomic<bool> go = false;
        std::vector<std::thread> threads;
        std::vector<std::optional<Lease>> leases;
        for (int i = 0; i < 4; ++i) leases.emplace_back();
        for (std::size_t i = 0; i < 4; ++i)
            threads.emplace_back([&, i] {
                while (!go) std::this_thread::yield();
                if (auto lease = Lease::claim(place)) {
                    leases[i].emplace(std::move(*lease));
                    ++holders;
                }
            });
        go = true;
        for (std::thread& thread : threads) thread.join();
        CHECK(holders <= 1);
        taken += holders;
    }
    // All may have seen each other and given up, now and then.
    CHECK(taken > 80);
}

TEST_CASE("expired leases are removed, others stay", "[lease]") {
    const Folder folder;
    putLease(folder.path, 1, 100);
    putLease(folder.path, 2, 10);
    writeFileAtomically(folder / "lease-x", "");
    removeExpiredLeases(folder.path);
    CHECK_FALSE(fs::exists(folder / "lease-1"));
    CHECK(fs::exists(folder / "lease-2"));
    CHECK(fs::exists(folder / "lease-x"));
    CHECK(isLeaseFile("lease-12"));
    for (const char* name : {"lease-", "lease-0", "lease-1x", "lease-x", "release-1"}) CHECK_FALSE(isLeaseFile(name));
}
