#pragma once
// What a call complains about.

#include <concepts>
#include <string>

#include "core/base/error.h"

namespace ulam {

inline bool mentions(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

struct Complaint {
    ExitCode code = ExitCode::Done;
    std::string message;  // empty: no complaint

    bool has(const std::string& part) const { return mentions(message, part); }
};

Complaint errorOf(std::invocable auto&& call) {
    try {
        call();
    } catch (const Error& error) {
        return {error.code(), error.what()};
    }
    return {};
}

}  // namespace ulam
