// Changing JSON by path, and writing it.

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/base/error.h"
#include "core/config/json.h"
#include "core/config/json_text.h"
#include "core/config/suggest.h"

namespace ulam {
namespace {

std::size_t arrayIndex(const Json& array, const std::string& step, std::string_view path) {
    std::size_t index = 0;
    const char* end = step.data() + step.size();
    const auto [stop, error] = std::from_chars(step.data(), end, index);
    if (error != std::errc() || stop != end || index >= array.size())
        fail(ExitCode::InvalidConfig, "cannot set {}: {} is no index of an array of {}", inQuotes(path), inQuotes(step),
             array.size());
    return index;
}

void refuseNonFinite(const Json& value, const std::string& pointer) {
    if (value.is_number_float() && !std::isfinite(value.get<double>()))
        fail(ExitCode::CannotWrite, "cannot write {} as JSON at {}", value.get<double>(),
             pointer.empty() ? "the top level" : pointer);
    if (!value.is_structured()) return;
    for (const auto& [name, member] : value.items())
        if (member.is_structured() || member.is_number_float())
            refuseNonFinite(member, pointer + '/' + escapePointerStep(name));
}

}  // namespace

std::vector<std::string> pathSteps(std::string_view path) {
    std::vector<std::string> steps(1);
    for (const char c : path) {
        if (c == '.')
            steps.emplace_back();
        else
            steps.back() += c;
    }
    if (std::find(steps.begin(), steps.end(), "") != steps.end())
        fail(ExitCode::InvalidConfig, "expected a path such as samplers.mlt.chains, found {}", inQuotes(path));
    if (steps.size() > kMaxJsonDepth)
        fail(ExitCode::InvalidConfig, "the path {} has more than {} steps", inQuotes(path), kMaxJsonDepth);
    return steps;
}

void setValueByPath(Json& root, std::string_view path, Json value) {
    const std::vector<std::string> steps = pathSteps(path);
    Json* parent = &root;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const bool isLast = i + 1 == steps.size();
        Json* member = nullptr;
        if (parent->is_array()) {
            member = &(*parent)[arrayIndex(*parent, steps[i], path)];
        } else if (parent->is_object()) {
            if (!isLast && !parent->contains(steps[i])) (*parent)[steps[i]] = Json::object();
            member = &(*parent)[steps[i]];
        } else {
            fail(ExitCode::InvalidConfig, "cannot set {}: expected an object or array before {}, found {}",
                 inQuotes(path), inQuotes(steps[i]), printable(parent->dump()));
        }
        parent = member;
    }
    *parent = std::move(value);
}

void setByPath(Json& root, std::string_view path, std::string_view text) {
    setValueByPath(root, path, overrideValue(text));
}

Json overrideValue(std::string_view text) {
    const bool looksLikeJson = !text.empty() && std::string_view("{[\"").find(text.front()) != std::string_view::npos;
    if (looksLikeJson) return parseJson(text, "value");
    try {
        return parseJson(text, "value");
    } catch (const Error&) {
        return Json(text);
    }
}

std::pair<std::string, std::string> splitAssignment(std::string_view assignment) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string_view::npos || equals == 0)
        fail(ExitCode::Usage, "expected --set path=value, found {}", inQuotes(assignment));
    return {std::string(assignment.substr(0, equals)), std::string(assignment.substr(equals + 1))};
}

void applyOverrides(Json& root, const std::vector<std::string>& assignments) {
    for (const std::string& assignment : assignments) {
        const auto [path, text] = splitAssignment(assignment);
        setByPath(root, path, text);
    }
}

bool isUtf8(std::string_view text) {
    if (std::none_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; })) return true;
    try {
        Json(text).dump();  // refuses any other
        return true;
    } catch (const Json::type_error&) {
        return false;
    }
}

std::string dump(const Json& value) {
    refuseNonFinite(value, "");
    try {
        return value.dump(2);
    } catch (const Json::type_error&) {
        fail(ExitCode::CannotWrite, "cannot write a string as JSON that is not UTF-8");
    }
}

}  // namespace ulam
