#pragma once
// What produced a result: program, build, machine.

#include <string>
#include <vector>

#include "core/config/json.h"

namespace ulam {

/// "0.1.0"
std::string programVersion();
/// Tells one build of the code from another: SHA-256 of the executable and of the plug-ins that were opened.
const std::string& codeHash();
/// To be called for each plug-in.
void addToCode(const std::string& plugin);

/// Program, build, libraries, machine, process and time; `arguments` is the command line.
Json provenance(const std::vector<std::string>& arguments);

/// The arguments of this process.
std::vector<std::string> processArguments();

/// The vector instructions that the program is compiled for and that rays are traced with: {"compiled": "avx2",
/// "ray_tracer": "avx512"}. With others images are rounded otherwise, and chains take other ways.
const Json& simd();

/// The processor's name as the kernel gives it; empty where it gives none.
const std::string& processorName();

/// "2025-01-31T12:00:00Z"
std::string utcNow();

}  // namespace ulam
