#include "experiments/engine/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "core/config/suggest.h"

namespace ulam {
namespace {

constexpr std::size_t kMostPoints = 100'000;

/// Points that exclude each other: the values of one key, or the pairs of a zip.
using Axis = std::vector<SweepPoint>;

std::vector<Json> logarithmic(const JsonNode& node) {
    node.allowOnly("key of a range", {"log", "steps"});
    const std::vector<double> ends = node.at("log").numbers(2);
    const auto steps = node.at("steps").integer();
    if (ends[0] <= 0 || ends[1] <= 0) node.at("log").expected("two numbers above 0");
    if (steps < 2 || steps > 1000) node.at("steps").expected("a whole number from 2 to 1000");
    const bool whole = ends[0] == std::floor(ends[0]) && ends[1] == std::floor(ends[1]);
    std::vector<Json> values;
    for (std::int64_t i = 0; i < steps; ++i) {
        double x = ends[0] * std::pow(ends[1] / ends[0], double(i) / double(steps - 1));
        if (i == steps - 1) x = ends[1];
        Json value = whole ? Json(std::llround(x)) : Json(x);
        if (values.empty() || values.back() != value) values.push_back(std::move(value));
    }
    return values;
}

std::vector<Json> valuesOf(const JsonNode& node) {
    if (node.isObject()) return logarithmic(node);
    if (!node.isArray() || node.size() == 0)
        node.expected("a list of values, or {\"log\": [first, last], \"steps\": n}");
    return std::vector<Json>(node.json().begin(), node.json().end());
}

/// A misspelt scene or sampler is no new one.
void checkPath(const JsonNode& node, const std::string& path, const JsonNode& experiment) {
    const std::vector<std::string> steps = pathSteps(path);
    if (steps.size() < 3 || (steps[0] != "scenes" && steps[0] != "samplers")) return;
    const auto section = experiment.find(steps[0]);
    if (!section || !section->isObject()) return;  // the parser says what is wrong with it
    std::vector<std::string> names;
    for (const auto& [name, member] : section->members()) names.push_back(name);
    if (std::find(names.begin(), names.end(), steps[1]) == names.end())
        unknownName(steps[0].substr(0, steps[0].size() - 1), steps[1], names, node.where());
}

std::string valueText(const Json& value) {
    std::string text = value.is_string()         ? value.get<std::string>()
                       : value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
                                                 : value.dump();
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '+' && c != '_') c = '_';
    return text;
}

Axis makeAxis(const std::string& path, const std::vector<Json>& values, const std::string& shortName) {
    constexpr std::size_t kLongest = 24;
    std::set<std::string> texts;
    bool plain = true;
    for (const Json& value : values) {
        const std::string text = valueText(value);
        plain = plain && value.is_primitive() && text.size() <= kLongest && texts.insert(text).second;
    }
    const bool numbered = !plain;  // dictionaries, long texts, and values that would look alike
    Axis axis;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string text = numbered ? fmt::format("no{}", i + 1) : valueText(values[i]);
        axis.push_back({SweepValue{path, values[i], fmt::format("{}={}", shortName, text)}});
    }
    return axis;
}

/// A key's last step, or all of it where another key ends the same way.
std::string shortName(const std::string& path, const std::vector<std::string>& paths) {
    const auto last = [](const std::string& p) { return p.substr(p.find_last_of('.') + 1); };
    const auto same =
        std::count_if(paths.begin(), paths.end(), [&](const std::string& p) { return last(p) == last(path); });
    return same > 1 ? path : last(path);
}

Axis zipAxis(const JsonNode& node, const std::vector<std::string>& paths, const JsonNode& experiment) {
    Axis axis;
    for (const auto& [path, values] : node.members()) {
        checkPath(values, path, experiment);
        const Axis column = makeAxis(path, valuesOf(values), shortName(path, paths));
        if (axis.empty()) axis.resize(column.size());
        if (column.size() != axis.size())
            values.expected(fmt::format("{} values as in the first list of the zip", axis.size()));
        for (std::size_t i = 0; i < axis.size(); ++i) axis[i].push_back(column[i].front());
    }
    if (axis.empty()) node.expected("at least one key");
    return axis;
}

}  // namespace

std::vector<SweepPoint> expandSweep(const JsonNode& sweep, const JsonNode& experiment) {
    std::vector<SweepPoint> points = {{}};
    if (sweep.isNull()) return points;
    std::vector<std::string> paths;
    for (const auto& [path, node] : sweep.members()) {
        if (path == "where")
            node.fail("\"where\" is not supported in a sweep", "lists, {\"log\": …, \"steps\": …} and \"zip\" are");
        if (path == "zip")
            for (const auto& [inner, values] : node.members()) paths.push_back(inner);
        else
            paths.push_back(path);
    }
    for (const auto& [path, node] : sweep.members()) {
        if (path == "sweep" || path.starts_with("sweep.")) node.fail("a sweep cannot change itself");
        Axis axis;
        if (path == "zip") {
            axis = zipAxis(node, paths, experiment);
        } else {
            checkPath(node, path, experiment);
            axis = makeAxis(path, valuesOf(node), shortName(path, paths));
        }
        std::vector<SweepPoint> next;
        for (const SweepPoint& point : points) {
            for (const SweepPoint& more : axis) {
                next.push_back(point);
                next.back().insert(next.back().end(), more.begin(), more.end());
            }
        }
        points = std::move(next);
        if (points.size() > kMostPoints) sweep.fail(fmt::format("the sweep has more than {} points", kMostPoints));
    }
    return points;
}

bool affects(const SweepValue& value, const std::string& scene, const std::string& sampler) {
    const auto foreign = [&](std::string_view section, const std::string& own) {
        const std::vector<std::string> steps = pathSteps(value.path);
        return steps.size() > 1 && steps[0] == section && steps[1] != own;
    };
    return !foreign("scenes", scene) && !foreign("samplers", sampler);
}

}  // namespace ulam
