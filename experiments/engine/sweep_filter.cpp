#include "experiments/engine/sweep_filter.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/config/suggest.h"

namespace ulam {
namespace {

const std::vector<std::string> kComparisons{"<", "<=", ">", ">=", "==", "!=", "in"};

const Json& valueAt(const JsonNode& node, const std::string& path, const Json& experiment) {
    const Json* value = &experiment;
    for (const std::string& step : pathSteps(path)) {
        const bool index = value->is_array() && !step.empty() && step.size() < 9 && std::all_of(step.begin(), step.end(), [](unsigned char c) { return std::isdigit(c); });
        if (value->is_object() && value->contains(step))
            value = &(*value)[step];
        else if (index && std::stoul(step) < value->size())
            value = &(*value)[std::stoul(step)];
        else
            node.fail(fmt::format("the experiment has no value at {}", inQuotes(path)), "defaults must be written to be compared");
    }
    if (!value->is_primitive() || value->is_null()) node.fail(fmt::format("{} is no single value", inQuotes(path)));
    return *value;
}

bool sameKind(const Json& a, const Json& b) {
    return (a.is_number() && b.is_number()) || (a.is_string() && b.is_string()) || (a.is_boolean() && b.is_boolean());
}

bool holds(const JsonNode& node, const Json& a, const std::string& comparison, const Json& b) {
    if (!sameKind(a, b) || (!a.is_number() && (comparison[0] == '<' || comparison[0] == '>')))
        node.fail(fmt::format("cannot compare {} {} {}", printable(a.dump()), comparison, printable(b.dump())));
    if (comparison == "==") return a == b;
    if (comparison == "!=") return a != b;
    return comparison == "<" ? a < b : comparison == "<=" ? a <= b : comparison == ">" ? a > b : a >= b;
}

bool isMet(const JsonNode& condition, const Json& experiment) {
    const Json& left = valueAt(condition[0], condition[0].string(), experiment);
    const std::string& comparison = condition[1].string();
    const JsonNode right = condition[2];
    if (comparison == "in") {
        const auto values = right.elements();
        return std::any_of(values.begin(), values.end(), [&](const JsonNode& v) { return holds(v, left, "==", v.json()); });
    }
    if (!right.isObject()) return holds(condition, left, comparison, right.json());
    return holds(condition, left, comparison, valueAt(right, right.at("path").string(), experiment));
}

}  // namespace

SweepFilter::SweepFilter(const std::optional<JsonNode>& where) {
    if (!where) return;
    conditions_ = where->elements();
    for (const JsonNode& condition : conditions_) {
        if (!condition.isArray() || condition.size() != 3) condition.expected("a condition: [path, comparison, value]");
        pathSteps(condition[0].string());
        const std::string& comparison = condition[1].string();
        if (std::find(kComparisons.begin(), kComparisons.end(), comparison) == kComparisons.end())
            unknownName("comparison", comparison, kComparisons, condition[1].where());
        const JsonNode right = condition[2];
        if (right.isObject()) {
            right.allowOnly("key of a value", {"path"});
            pathSteps(right.at("path").string());
        }
        const bool list = comparison == "in";
        if (right.isNull() || right.isArray() != list || (list && right.size() == 0))
            right.expected(list ? "a list of values" : "a number, a text, true, false or {\"path\": …}");
    }
}

bool SweepFilter::passes(const Json& experiment) const {
    return std::all_of(conditions_.begin(), conditions_.end(), [&](const JsonNode& condition) { return isMet(condition, experiment); });
}

}  // namespace ulam
