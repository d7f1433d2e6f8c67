#include "experiments/engine/sweep_values.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/random.h"

namespace ulam {
namespace {

/// Beyond 2^53 a double no longer tells neighbouring whole numbers apart.
constexpr double kLargestWhole = 9007199254740992.0;

bool isWhole(double x) {
    return x == std::floor(x) && std::abs(x) <= kLargestWhole;
}

/// Where t in [0, 1] is between the ends, which are exact.
double between(double first, double last, double t, bool logarithmic) {
    // Their ratio may be infinite.
    return logarithmic ? std::pow(first, 1 - t) * std::pow(last, t) : first * (1 - t) + last * t;
}

std::vector<Json> rangeOf(const JsonNode& node, std::uint64_t stream) {
    const bool logarithmic = node.find("log").has_value(), drawn = node.find("draws").has_value();
    const char *scale = logarithmic ? "log" : "linear", *number = drawn ? "draws" : "steps";
    node.allowOnly("key of a range", {scale, number});
    std::vector<double> ends = node.at(scale).numbers(2);
    const auto count = node.at(number).integer();
    if (logarithmic && !(std::min(ends[0], ends[1]) > 0)) node.at(scale).expected("two numbers above 0");
    const std::int64_t least = drawn ? 1 : 2;
    if (count < least || count > kMostSweepValues)
        node.at(number).expected(fmt::format("a whole number from {} to {}", least, kMostSweepValues));
    const bool whole = isWhole(ends[0]) && isWhole(ends[1]);
    if (drawn && whole) {
        // Each whole number stands for the values from it up to the next one.
        std::sort(ends.begin(), ends.end());
        ends[1] += 1;
    }
    Random random(makeKey(stream), 0, 0);
    std::vector<Json> values;
    for (std::int64_t i = 0; i < count; ++i) {
        const double x = between(ends[0], ends[1], drawn ? random() : double(i) / double(count - 1), logarithmic);
        values.push_back(!whole ? Json(x) : Json(std::llround(drawn ? std::min(std::floor(x), ends[1] - 1) : x)));
    }
    return values;
}

}  // namespace

std::vector<Json> sweepValues(const JsonNode& node, std::uint64_t stream) {
    if (node.isObject()) return rangeOf(node, stream);
    if (!node.isArray() || node.size() == 0)
        node.expected("a list of values, or a range: {\"linear\" or \"log\": [first, last], \"steps\" or \"draws\": n}");
    return std::vector<Json>(node.json().begin(), node.json().end());
}

}  // namespace ulam
