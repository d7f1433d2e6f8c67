#pragma once
// What produced a result: program, build, machine.

#include <string>
#include <vector>

#include "core/config/json.h"

namespace ulam {

/// "0.1.0"
std::string programVersion();
/// SHA-256 of the executable.
const std::string& programHash();

/// Program, build, libraries, machine, process and time; `arguments` is the command line.
Json provenance(const std::vector<std::string>& arguments);

/// The arguments of this process.
std::vector<std::string> processArguments();

/// "2025-01-31T12:00:00Z"
std::string utcNow();

}  // namespace ulam
