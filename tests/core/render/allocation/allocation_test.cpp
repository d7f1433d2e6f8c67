// No sampler allocates memory in its loop. A program of its own, because it replaces the global operator new.

#include <atomic>
#include <cstdlib>
#include <new>

#include "core/mcmc/sample.h"
#include "tests/support/known_answers.h"
#include "tests/support/path_scenes.h"

namespace {
std::atomic<uint64_t> allocations = 0;

void* counted(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}
}  // namespace

// The sized and array forms call these.
void* operator new(std::size_t size) {
    return counted(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    ++allocations;
    const auto a = std::size_t(alignment);
    if (void* memory = std::aligned_alloc(a, (size + a - 1) / a * a)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

using namespace ulam;

namespace {

/// Allocations in the second half of the work, the first being the warm-up.
uint64_t allocationsOf(const Scene& scene, const Json& sampler) {
    constexpr uint64_t kChunks = 100;
    const auto made = Registry<Sampler>::instance().create(JsonNode(sampler));
    const auto run = made->start({scene, makeKey(3), 1, 0, 0, 0});
    run->prepare([](int) { return false; });
    uint64_t before = 0;
    for (uint64_t i = 0; i < 2 * kChunks; ++i) {
        if (i == kChunks) before = allocations;
        run->work(0, i * run->chunk(), (i + 1) * run->chunk());
    }
    return allocations - before;
}

/// All registered mutations that work on a target.
Json mutations(bool onPaths) {
    Json all = Json::object();
    for (const auto* entry : Registry<Mutation>::instance().entries())
        if (onPaths || entry->create(JsonNode(Json::object()))->space() == Space::Primary)
            all[entry->name] = Json::object();
    return all;
}

}  // namespace

TEST_CASE("the counter counts") {
    const uint64_t before = allocations;
    auto* memory = new std::vector<int>(100);
    CHECK(allocations == before + 2);
    delete memory;
}

TEST_CASE("no sampler allocates memory in its loop") {
    for (const PathScene& named : pathScenes()) {
        const Scene scene = buildScene(named.dictionary);
        const int chains = 20, bootstrap = 2000;
        for (const Json& sampler :
             {Json{{"type", "mlt"}, {"chains", chains}, {"bootstrap", bootstrap}, {"mutations", mutations(true)}},
              Json{{"type", "pssmlt"}, {"chains", chains}, {"bootstrap", bootstrap}, {"mutations", mutations(false)}},
              Json{{"type", "pssmlt"},
                   {"base", "path"},
                   {"deposit", "expected_values"},
                   {"chains", chains},
                   {"bootstrap", bootstrap}},
              Json{{"type", "bdpt"}}, Json{{"type", "path"}}, Json{{"type", "light"}}}) {
            INFO(named.name << " " << sampler.dump());
            CHECK(allocationsOf(scene, sampler) == 0);
        }
    }
}
