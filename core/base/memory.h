#pragma once
// The memory of this process: what it holds, what it is going to need, and what it may take.

#include <cstdint>
#include <string>
#include <vector>

namespace ulam {

/// Something that takes memory.
struct MemoryNeed {
    std::string what;  ///< "the films of 8 threads"
    double bytes;
    std::string remedy;  ///< what makes it smaller: "a smaller film"
};
/// What is there at the same time.
using MemoryNeeds = std::vector<MemoryNeed>;

double totalBytes(const MemoryNeeds& needs);

/// What the process has in memory now, its program and libraries included, and the most it has had.
uint64_t residentBytes();
uint64_t peakResidentBytes();

/// "1.5 GB", in powers of 1024.
std::string sizeText(double bytes);

/// What requireMemory lets pass from now on; before, everything.
void limitMemory(uint64_t bytes);
bool memoryIsLimited();

/// Called before memory is taken for `purpose`: `needed` comes to what is resident, of which `held` names parts. Fails with
/// InvalidConfig where all together exceed the limit; the message has every part, the largest first.
void requireMemory(const std::string& purpose, const MemoryNeeds& held, const MemoryNeeds& needed);

/// The same before a file is read, where it is large: small ones are not worth the look.
void requireMemoryToRead(const std::string& path, const MemoryNeed& content);

/// The most that all together came to in any of these calls, and at least what the process had had by then: the estimate of
/// its peak.
uint64_t expectedPeakBytes();

}  // namespace ulam
