#include "core/base/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include "core/base/error.h"

namespace ulam {
namespace {

std::atomic<uint64_t> limit = std::numeric_limits<uint64_t>::max(), expectedPeak = 0;

}  // namespace

double totalBytes(const MemoryNeeds& needs) {
    double sum = 0;
    for (const MemoryNeed& need : needs) sum += need.bytes;
    return sum;
}

uint64_t residentBytes() {
    uint64_t size = 0, resident = 0;  // in pages
    std::ifstream("/proc/self/statm") >> size >> resident;
    return resident * uint64_t(::sysconf(_SC_PAGESIZE));
}

uint64_t peakResidentBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return uint64_t(usage.ru_maxrss) * 1024;
}

std::string sizeText(double bytes) {
    constexpr const char* kUnits[] = {"bytes", "KB", "MB", "GB", "TB"};
    size_t unit = 0;
    for (; bytes >= 1000 && unit + 1 < std::size(kUnits); ++unit) bytes /= 1024;
    return fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

void limitMemory(uint64_t bytes) { limit = bytes; }

bool memoryIsLimited() {
    return limit != std::numeric_limits<uint64_t>::max();
}

void requireMemory(const std::string& purpose, const MemoryNeeds& held, const MemoryNeeds& needed) {
    MemoryNeeds parts = held;
    parts.push_back({"the program and what else it holds", std::max(0.0, double(residentBytes()) - totalBytes(held)), ""});
    parts.insert(parts.end(), needed.begin(), needed.end());
    const double total = totalBytes(parts);
    const uint64_t expected = std::max(uint64_t(total), peakResidentBytes());
    uint64_t most = expectedPeak;
    while (most < expected && !expectedPeak.compare_exchange_weak(most, expected)) {}
    if (total <= double(limit)) return;
    std::ranges::stable_sort(parts, std::greater(), &MemoryNeed::bytes);
    std::string list;
    for (const MemoryNeed& part : parts) {
        if (part.bytes < 1) continue;
        list += fmt::format("\n    {:>8}  {}", sizeText(part.bytes), part.what);
        if (!part.remedy.empty()) list += fmt::format(" (less with {})", part.remedy);
    }
    fail(ExitCode::InvalidConfig, "{} needs about {} of memory, and --max-memory allows {}:{}", purpose, sizeText(total), sizeText(double(limit)), list);
}

void requireMemoryToRead(const std::string& path, const MemoryNeed& content) {
    constexpr double kLarge = 16 << 20;
    if (content.bytes > kLarge) requireMemory("reading " + path, {}, {content});
}

uint64_t expectedPeakBytes() { return expectedPeak; }

}  // namespace ulam
