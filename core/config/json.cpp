#include "core/config/json.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/json_text.h"
#include "core/config/suggest.h"

namespace ulam {

struct JsonSource {
    struct Change {
        std::string pointer;
        std::string origin;
    };
    std::string name;
    std::shared_ptr<const std::string> text;
    std::vector<Change> changes;

    /// What last set the value at this pointer or one it is part of.
    const Change* changeOf(std::string_view pointer) const {
        const auto covers = [&](const Change& change) {
            const std::string_view rest = pointer.substr(std::min(pointer.size(), change.pointer.size()));
            return pointer.starts_with(change.pointer) && (rest.empty() || rest.front() == '/');
        };
        const auto last = std::find_if(changes.rbegin(), changes.rend(), covers);
        return last == changes.rend() ? nullptr : &*last;
    }
};

namespace {

std::string describe(const Json& value) {
    switch (value.type()) {
        case Json::value_t::null:
        case Json::value_t::boolean:
            return value.dump();
        case Json::value_t::string:
            return "the string " + inQuotes(value.get_ref<const std::string&>());
        case Json::value_t::array:
            return value.empty() ? "an empty array" : fmt::format("an array of {}", value.size());
        case Json::value_t::object:
            return "an object";
        case Json::value_t::number_float:
            return fmt::format("{}", value.get<double>());
        default:
            return value.dump();
    }
}

// Beyond 2^53 a double no longer tells neighbouring whole numbers apart.
constexpr double kLargestExactInteger = 9007199254740992.0;

bool isWholeFloat(const Json& value) {
    if (!value.is_number_float()) return false;
    const double number = value.get<double>();
    return std::abs(number) <= kLargestExactInteger && number == std::trunc(number);
}

}  // namespace

JsonNode::JsonNode(Json value) : value_(std::make_shared<const Json>(std::move(value))) {}

JsonNode::JsonNode(std::shared_ptr<const Json> value, std::shared_ptr<const JsonSource> source, std::string pointer)
    : value_(std::move(value)), source_(std::move(source)), pointer_(std::move(pointer)) {}

std::string JsonNode::key() const {
    const auto steps = pointerSteps(pointer_);
    return steps.empty() ? "" : steps.back();
}

std::string JsonNode::where() const {
    const std::string shown = pointer_.empty() ? "" : printable(pointer_, 200);
    if (!source_) return shown.empty() ? "the top level" : shown;
    const std::string suffix = shown.empty() ? "" : fmt::format(" ({})", shown);
    if (const auto* change = source_->changeOf(pointer_)) return change->origin + suffix;
    const auto offset = locate(*source_->text, pointerSteps(pointer_));
    return (offset ? placeOf(source_->name, *source_->text, *offset) : source_->name) + suffix;
}

double JsonNode::number() const {
    if (!isNumber() || !std::isfinite(value_->get<double>())) expected("a number");
    return value_->get<double>();
}

std::int64_t JsonNode::integer() const {
    if (isWholeFloat(*value_)) return static_cast<std::int64_t>(value_->get<double>());
    if (!value_->is_number_integer()) expected("an integer");
    if (value_->is_number_unsigned() && value_->get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max())
        expected("an integer below 2^63");
    return value_->get<std::int64_t>();
}

std::uint64_t JsonNode::unsignedInteger() const {
    if (value_->is_number_unsigned()) return value_->get<std::uint64_t>();
    const bool whole = value_->is_number_integer() || isWholeFloat(*value_);
    if (!whole || value_->get<double>() < 0) expected("an integer >= 0");
    return value_->get<std::uint64_t>();
}

bool JsonNode::boolean() const {
    if (!isBoolean()) expected("true or false");
    return value_->get<bool>();
}

const std::string& JsonNode::string() const {
    if (!isString()) expected("a string");
    return value_->get_ref<const std::string&>();
}

std::vector<double> JsonNode::numbers() const {
    if (!isArray()) expected("an array of numbers");
    std::vector<double> result;
    result.reserve(value_->size());
    for (std::size_t i = 0; i < value_->size(); ++i) {
        const Json& element = (*value_)[i];
        // A node per element only where there is something to say about it.
        const bool good = element.is_number() && std::isfinite(element.get<double>());
        result.push_back(good ? element.get<double>() : (*this)[i].number());
    }
    return result;
}

std::vector<double> JsonNode::numbers(std::size_t count) const {
    if (!isArray() || size() != count) expected(fmt::format("an array of {} numbers", count));
    return numbers();
}

JsonNode JsonNode::at(std::string_view key) const {
    if (auto member = find(key)) return *member;
    std::vector<std::string> present;
    for (const auto& [name, value] : value_->items()) present.push_back(name);
    const std::string near = nearestName(key, present);
    fail(fmt::format("{} is missing from the object", inQuotes(key)),
         near.empty() ? "" : fmt::format("it has {}", inQuotes(near)));
}

std::optional<JsonNode> JsonNode::find(std::string_view key) const {
    if (!isObject()) expected("an object");
    const auto member = value_->find(std::string(key));
    if (member == value_->end()) return {};
    return child(*member, key);
}

JsonNode JsonNode::operator[](std::size_t index) const {
    if (!isArray()) expected("an array");
    if (index >= size()) expected(fmt::format("an array of {} or more", index + 1));
    return child((*value_)[index], std::to_string(index));
}

std::size_t JsonNode::size() const {
    if (!isArray() && !isObject()) expected("an array or an object");
    return value_->size();
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
    if (!isObject()) expected("an object");
    std::vector<std::pair<std::string, JsonNode>> result;
    for (const auto& [name, value] : value_->items()) result.emplace_back(name, child(value, name));
    return result;
}

std::vector<JsonNode> JsonNode::elements() const {
    if (!isArray()) expected("an array");
    std::vector<JsonNode> result;
    for (std::size_t i = 0; i < size(); ++i) result.push_back((*this)[i]);
    return result;
}

void JsonNode::allowOnly(std::string_view kind, const std::vector<std::string>& allowed) const {
    if (!isObject()) expected("an object");
    for (const auto& [name, value] : value_->items())
        if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
            unknownName(kind, name, allowed, child(value, name).where());
}

void JsonNode::fail(std::string_view message, std::string_view hint) const {
    ulam::fail(ExitCode::InvalidConfig, "{} at {}{}{}", message, where(), hint.empty() ? "" : "; ", hint);
}

void JsonNode::expected(std::string_view what, std::string_view hint) const {
    fail(fmt::format("expected {}, found {}", what, describe(*value_)), hint);
}

JsonNode JsonNode::child(const Json& value, std::string_view key) const {
    return JsonNode(std::shared_ptr<const Json>(value_, &value), source_, pointer_ + '/' + escapePointerStep(key));
}

JsonDocument::JsonDocument(std::shared_ptr<const Json> value, std::shared_ptr<const JsonSource> source)
    : value_(std::move(value)), source_(std::move(source)) {}

JsonDocument JsonDocument::fromText(std::string text, std::string name) {
    if (text.size() > kMaxJsonBytes) fail(ExitCode::InvalidConfig, "{} holds more than {} bytes", name, kMaxJsonBytes);
    auto value = std::make_shared<const Json>(parseJson(text, name));
    auto shared = std::make_shared<const std::string>(std::move(text));
    return {std::move(value), std::make_shared<const JsonSource>(JsonSource{std::move(name), std::move(shared), {}})};
}

JsonDocument JsonDocument::fromParts(Json value, std::string name, std::vector<std::pair<std::string, std::string>> places) {
    JsonSource source{std::move(name), std::make_shared<const std::string>(), {}};
    for (auto& place : places) source.changes.push_back({std::move(place.first), std::move(place.second)});
    return {std::make_shared<const Json>(std::move(value)), std::make_shared<const JsonSource>(std::move(source))};
}

JsonDocument JsonDocument::fromFile(const std::filesystem::path& path) {
    return fromText(readFile(path, kMaxJsonBytes), path.string());
}

const std::string& JsonDocument::name() const {
    return source_->name;
}

std::optional<TextPosition> JsonDocument::position(std::string_view pointer) const {
    if (!pointer.empty() && pointer.front() != '/') return {};
    const auto offset = locate(*source_->text, pointerSteps(pointer));
    if (!offset || source_->changeOf(pointer)) return {};
    return positionAt(*source_->text, *offset);
}

void JsonDocument::set(std::string_view path, Json value, std::string origin) {
    auto changed = std::make_shared<Json>(*value_);
    setValueByPath(*changed, path, std::move(value));
    auto source = std::make_shared<JsonSource>(*source_);
    std::string pointer;
    for (const std::string& step : pathSteps(path)) pointer += '/' + escapePointerStep(step);
    source->changes.push_back({std::move(pointer), std::move(origin)});
    value_ = std::move(changed);
    source_ = std::move(source);
}

void JsonDocument::applyOverrides(const std::vector<std::string>& assignments) {
    for (const std::string& assignment : assignments) {
        const auto [path, text] = splitAssignment(assignment);
        set(path, overrideValue(text), "--set " + printable(assignment, 200));
    }
}

}  // namespace ulam
