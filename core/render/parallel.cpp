#include "core/render/parallel.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace ulam {

uint64_t forEachChunk(int workers, uint64_t first, uint64_t limit, uint64_t chunk, const StopFunction& stop,
                      const std::function<void(int, uint64_t, uint64_t)>& work) {
    std::atomic<uint64_t> next = first / chunk;
    std::atomic<uint64_t> done = first;
    std::atomic<bool> failed = false;
    std::mutex mutex;
    std::exception_ptr error;
    auto loop = [&](int worker) {
        while (!failed.load(std::memory_order_relaxed) && !stop(worker)) {
            const uint64_t i = next.fetch_add(1);
            if (i * chunk >= limit) break;
            const uint64_t begin = std::max(first, i * chunk), end = std::min(limit, (i + 1) * chunk);
            try {
                work(worker, begin, end);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!error) error = std::current_exception();
                failed = true;
            }
            done += end - begin;
        }
    };
    {
        // Threads of our own and not TBB's: Embree, told to build its tree with one thread, limits TBB to one thread for
        // as long as the scene lives.
        std::vector<std::jthread> threads;
        for (int worker = 1; worker < workers; ++worker) threads.emplace_back(loop, worker);
        loop(0);
    }
    if (error) std::rethrow_exception(error);
    return done;
}

}  // namespace ulam
