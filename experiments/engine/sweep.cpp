#include "experiments/engine/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>
#include <string_view>

#include "core/base/sha256.h"
#include "core/config/suggest.h"
#include "experiments/engine/sweep_filter.h"
#include "experiments/engine/sweep_values.h"

namespace ulam {
namespace {

constexpr std::size_t kMostPoints = 100'000;
/// What a run has once: a point cannot have its own. Reference, replicates and all that cells are made of can differ.
constexpr std::array<std::string_view, 9> kWholeRun{"$schema", "extends", "name", "baseline",             "seed",
                                                    "metrics", "until",   "tune", "common_random_numbers"};

/// Points that exclude each other: the values of one key, or the pairs of a zip.
using Axis = std::vector<SweepPoint>;

/// A key of a sweep with the node of its values.
using Key = std::pair<std::string, JsonNode>;

/// All keys in the order in which a point sets them, those of the zip in its place.
std::vector<Key> keysOf(const JsonNode& sweep) {
    std::vector<Key> keys;
    for (const auto& [path, node] : sweep.members()) {
        if (path == "where") continue;
        const std::vector<Key> own = path == "zip" ? node.members() : std::vector<Key>{{path, node}};
        keys.insert(keys.end(), own.begin(), own.end());
    }
    return keys;
}

/// A misspelt scene or sampler is no new one.
void checkPath(const JsonNode& node, const std::string& path, const JsonNode& experiment) {
    const std::vector<std::string> steps = pathSteps(path);
    if (steps[0] == "sweep") node.fail("a sweep cannot change itself");
    if (std::find(kWholeRun.begin(), kWholeRun.end(), steps[0]) != kWholeRun.end())
        node.fail(fmt::format("a sweep cannot change {}, which belongs to the whole run", inQuotes(path)),
                  steps[0] == "seed" ? "independent runs are \"replicates\"" : "");
    if (steps.size() < 3 || (steps[0] != "scenes" && steps[0] != "samplers")) return;
    const auto section = experiment.find(steps[0]);
    if (!section || !section->isObject()) return;  // the parser says what is wrong with it
    std::vector<std::string> names;
    for (const auto& [name, member] : section->members()) names.push_back(name);
    if (std::find(names.begin(), names.end(), steps[1]) == names.end())
        unknownName(steps[0].substr(0, steps[0].size() - 1), steps[1], names, node.where());
}

/// Every value of a point must reach its cells: a later key must not set the same again, nor what contains it.
void checkKeys(const std::vector<Key>& keys, const JsonNode& experiment) {
    std::vector<std::pair<std::string, std::vector<std::string>>> earlier;
    for (const auto& [path, node] : keys) {
        checkPath(node, path, experiment);
        std::vector<std::string> steps = pathSteps(path);
        for (const auto& [other, others] : earlier) {
            if (others == steps) node.fail(fmt::format("the sweep has the key {} twice", inQuotes(path)));
            if (others.size() > steps.size() && std::equal(steps.begin(), steps.end(), others.begin()))
                node.fail(fmt::format("{} replaces what {} has set", inQuotes(path), inQuotes(other)),
                          "put the shorter key first");
        }
        earlier.emplace_back(path, std::move(steps));
    }
}

std::string valueText(const Json& value) {
    std::string text = value.is_string()         ? value.get<std::string>()
                       : value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
                                                 : value.dump();
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '+' && c != '_') c = '_';
    return text;
}

Axis makeAxis(const std::string& path, const std::vector<Json>& values, const std::vector<std::string>& paths) {
    constexpr std::size_t kLongest = 24;
    std::map<nlohmann::json, std::size_t> firsts;  // a zip may repeat a value in a column, which is the same value then
    std::vector<std::size_t> numbers;
    std::map<std::string, std::size_t> texts;
    bool plain = true;
    for (const Json& value : values) {
        const std::size_t number = firsts.try_emplace(value, numbers.size() + 1).first->second;
        numbers.push_back(number);
        const std::string text = valueText(value);
        plain = plain && value.is_primitive() && text.size() <= kLongest &&
                texts.try_emplace(text, number).first->second == number;
    }
    const bool numbered = !plain;  // dictionaries, long texts, and values that would look alike
    const std::string shortest = shortName(path, paths);
    const std::string& name = shortest.find('.') == shortest.npos ? shortest : path;
    Axis axis;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string text = numbered ? fmt::format("no{}", numbers[i]) : valueText(values[i]);
        axis.push_back({SweepValue{path, values[i], fmt::format("{}={}", name, text), fmt::format("{}={}", shortest, text)}});
    }
    return axis;
}

/// The values of a key, where those of a range are drawn by the experiment's seed.
std::vector<Json> valuesOf(const JsonNode& node, const std::string& path, const JsonNode& experiment) {
    const auto seed = experiment.find("seed");
    return sweepValues(node, hash64(fmt::format("{} {}", seed ? seed->json().dump() : "", path)));
}

/// Of a range, steps that round to the same number and repeated draws are one point of a grid.
std::vector<Json> distinct(const JsonNode& node, std::vector<Json> values) {
    if (!node.isObject()) return values;
    std::vector<Json> once;
    for (Json& value : values)
        if (std::find(once.begin(), once.end(), value) == once.end()) once.push_back(std::move(value));
    return once;
}

Axis zipAxis(const JsonNode& node, const std::vector<std::string>& paths, const JsonNode& experiment) {
    Axis axis;
    for (const auto& [path, values] : node.members()) {
        const Axis column = makeAxis(path, valuesOf(values, path, experiment), paths);
        if (axis.empty()) axis.resize(column.size());
        if (column.size() != axis.size())
            values.expected(fmt::format("{} values as in the first list of the zip", axis.size()));
        for (std::size_t i = 0; i < axis.size(); ++i) axis[i].push_back(column[i].front());
    }
    if (axis.empty()) node.expected("at least one key");
    return axis;
}

/// Points are the same where their numbers are: 2 is 2.0.
void refuseRepeated(const Axis& axis, const JsonNode& node) {
    std::set<std::vector<nlohmann::json>> seen;
    for (const SweepPoint& point : axis) {
        std::vector<nlohmann::json> values;
        std::vector<std::string> texts;
        for (const SweepValue& value : point) {
            values.emplace_back(value.value);
            texts.push_back(fmt::format("{} = {}", value.path, value.value.dump()));
        }
        if (!seen.insert(std::move(values)).second)
            node.fail(fmt::format("the sweep has {} twice", printable(fmt::format("{}", fmt::join(texts, ", ")))));
    }
}

}  // namespace

std::vector<SweepPoint> expandSweep(const JsonNode& sweep, const JsonNode& experiment) {
    std::vector<SweepPoint> points = {{}};
    if (sweep.isNull()) return points;
    const std::vector<Key> keys = keysOf(sweep);
    checkKeys(keys, experiment);
    std::vector<std::string> paths;
    for (const auto& [path, node] : keys) paths.push_back(path);

    std::vector<Axis> axes;
    std::size_t count = 1;
    for (const auto& [path, node] : sweep.members()) {
        if (path == "where") continue;
        axes.push_back(path == "zip" ? zipAxis(node, paths, experiment)
                                     : makeAxis(path, distinct(node, valuesOf(node, path, experiment)), paths));
        refuseRepeated(axes.back(), node);
        // Before any point is made, and without computing a product that could overflow.
        if (axes.back().size() > kMostPoints / count)
            sweep.fail(fmt::format("the sweep has more than {} points", kMostPoints));
        count *= axes.back().size();
    }
    for (const Axis& axis : axes) {
        std::vector<SweepPoint> next;
        for (const SweepPoint& point : points) {
            for (const SweepPoint& more : axis) {
                next.push_back(point);
                next.back().insert(next.back().end(), more.begin(), more.end());
            }
        }
        points = std::move(next);
    }
    const SweepFilter filter(sweep.find("where"));
    if (filter.empty()) return points;
    std::erase_if(points, [&](const SweepPoint& point) {
        Json changed = experiment.json();
        for (const SweepValue& value : point) setValueByPath(changed, value.path, value.value);
        return !filter.passes(changed);
    });
    if (points.empty()) sweep.at("where").fail("no point of the sweep meets the conditions");
    return points;
}

std::string shortName(const std::string& path, const std::vector<std::string>& paths) {
    for (std::size_t dot = path.rfind('.'); dot != path.npos; dot = path.rfind('.', dot - 1)) {
        const std::string end = path.substr(dot);
        if (std::ranges::count_if(paths, [&](const std::string& p) { return ('.' + p).ends_with(end); }) == 1)
            return end.substr(1);
    }
    return path;
}

bool affects(const SweepValue& value, const std::string& scene, const std::string& sampler) {
    const auto foreign = [&](std::string_view section, const std::string& own) {
        const std::vector<std::string> steps = pathSteps(value.path);
        return steps.size() > 1 && steps[0] == section && steps[1] != own;
    };
    return !foreign("scenes", scene) && !foreign("samplers", sampler);
}

}  // namespace ulam
