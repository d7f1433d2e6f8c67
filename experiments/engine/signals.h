#pragma once
// SIGINT and SIGTERM as a wish: work stops at the next opportunity and keeps what is finished. A second signal kills.

#include <atomic>
#include <string>

namespace ulam {

/// Installs the handlers. The flag is set by the first signal.
const std::atomic<bool>& watchSignals();

/// Throws Interrupted or Terminated, after which `message` stands, if a signal came.
void failIfSignalled(const std::string& message);

}  // namespace ulam
