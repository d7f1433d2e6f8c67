#include "experiments/engine/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace ulam {
namespace {

constexpr double kTerminalInterval = 0.2, kLogInterval = 15;  // seconds

}  // namespace

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO)) {}

bool Progress::isDue() const {
    const double elapsed = std::chrono::duration<double>(Clock::now() - last_).count();
    return !quiet_ && elapsed >= (terminal_ ? kTerminalInterval : kLogInterval);
}

void Progress::update(double fraction, const std::string& what) {
    if (!isDue()) return;
    const auto now = Clock::now();
    last_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    std::string line = fmt::format("{:5.1f} %  {}", 100 * fraction, what);
    // The first moments tell little about the rest.
    if (fraction > 0.01) line += fmt::format("  {} left", durationText(elapsed / fraction * (1 - fraction)));
    fmt::print(stderr, "{}{}{}", terminal_ ? "\r\x1b[K" : "", line, terminal_ ? "" : "\n");
    std::fflush(stderr);
    shown_ = terminal_;
}

void Progress::message(const std::string& text) {
    clear();
    fmt::print(stderr, "{}\n", text);
}

void Progress::clear() {
    if (shown_) fmt::print(stderr, "\r\x1b[K");
    shown_ = false;
}

std::string durationText(double seconds) {
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const auto s = static_cast<long long>(std::llround(seconds));
    if (s < 60) return fmt::format("{} s", s);
    if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
    if (s < 48 * 3600) return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
    return fmt::format("{} days {} h", s / 86400, s % 86400 / 3600);
}

}  // namespace ulam
