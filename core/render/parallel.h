#pragma once
// Handing out ranges of work to a fixed number of workers.

#include <cstdint>
#include <functional>

namespace ulam {

/// Asked by every worker, by its number, before it takes more work.
using StopFunction = std::function<bool(int worker)>;

/// Calls work(worker, begin, end) for the ranges between `first` and `limit` that end at multiples of `chunk`, in order,
/// until `stop(worker)` says so; returns where it stopped: everything before is done, nothing after. At most one call
/// per worker at a time. Rethrows the first exception of a worker.
uint64_t forEachChunk(int workers, uint64_t first, uint64_t limit, uint64_t chunk, const StopFunction& stop,
                      const std::function<void(int, uint64_t, uint64_t)>& work);

}  // namespace ulam
