#pragma once
// Errors that end a command. The exit code is part of the program's contract with scripts.

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace ulam {

enum class ExitCode : int {
    Done = 0,
    SomeCellsFailed = 1,
    Usage = 2,
    VerificationRejected = 3,
    InvalidConfig = 4,
    InputMissing = 5,
    CannotWrite = 6,
    Interrupted = 130,
    Terminated = 143,
};

/// What went wrong, for a person: file, place, what was expected and what was found are part of the message.
class Error : public std::runtime_error {
public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const { return code_; }

private:
    ExitCode code_;
};

template <class... Arguments>
[[noreturn]] void fail(ExitCode code, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    throw Error(code, fmt::format(format, std::forward<Arguments>(arguments)...));
}

}  // namespace ulam
