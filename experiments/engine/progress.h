#pragma once
// Progress on stderr: one line that is written over on a terminal, a line now and then elsewhere.

#include <chrono>
#include <string>

namespace ulam {

class Progress {
public:
    explicit Progress(bool quiet);
    ~Progress() { clear(); }

    /// Whether an update would show now: of much work the fraction takes long to find.
    bool isDue() const;
    /// `fraction` of all work done; `what` is being done now.
    void update(double fraction, const std::string& what);
    /// A line of its own, above the progress line. Not silenced by quiet.
    void message(const std::string& text);
    /// Takes the progress line off the terminal.
    void clear();

private:
    using Clock = std::chrono::steady_clock;

    bool quiet_, terminal_;
    bool shown_ = false;
    Clock::time_point start_ = Clock::now(), last_ = start_;
};

/// "1.2 s", "3 min 20 s", "2 h 5 min"
std::string durationText(double seconds);

}  // namespace ulam
