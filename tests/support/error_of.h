#pragma once
// What a call complains about.

#include <string>
#include <utility>

#include "core/base/error.h"

namespace ulam {

struct Complaint {
    ExitCode code = ExitCode::Done;
    std::string message;  // empty: no complaint

    bool has(const std::string& part) const { return message.find(part) != std::string::npos; }
};

template <class Call>
Complaint errorOf(Call&& call) {
    try {
        std::forward<Call>(call)();
    } catch (const Error& error) {
        return {error.code(), error.what()};
    }
    return {};
}

}  // namespace ulam
