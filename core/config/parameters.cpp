#include "core/config/parameters.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "core/base/error.h"
#include "core/config/suggest.h"

namespace ulam {
namespace {

template <class... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

/// The shortest decimal that reads back as the same float: 0.1, not 0.10000000149011612.
double decimal(float value) {
    return std::stod(fmt::format("{}", value));
}

Json valueOf(const ParameterMember& member) {
    return std::visit(
        Overloaded{[](const float* value) { return Json(decimal(*value)); },
                   [](const Spectrum* value) {
                       return Json({value->x, value->y, value->z});
                   },
                   [](const JsonNode* value) { return value->json(); }, [](const auto* value) { return Json(*value); }},
        member);
}

const char* typeOf(const ParameterMember& member) {
    return std::visit(
        []<class T>(const T*) {
            if constexpr (std::is_same_v<T, bool>)
                return "boolean";
            else if constexpr (std::is_integral_v<T>)
                return "integer";
            else if constexpr (std::is_floating_point_v<T>)
                return "number";
            else if constexpr (std::is_same_v<T, std::string>)
                return "string";
            else if constexpr (std::is_same_v<T, std::vector<double>>)
                return "numbers";
            else if constexpr (std::is_same_v<T, Spectrum>)
                return "spectrum";
            else
                return "json";
        },
        member);
}

/// The smallest or largest value of an integer's type.
Json limitOf(const ParameterMember& member, bool largest) {
    return std::visit(
        [largest]<class T>(const T*) -> Json {
            if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>)
                return largest ? std::numeric_limits<T>::max() : std::numeric_limits<T>::min();
            else
                return nullptr;
        },
        member);
}

bool inRange(double value, const ParameterInfo& info) {
    if (info.min && (info.minExclusive ? value <= *info.min : value < *info.min)) return false;
    return !info.max || (info.maxExclusive ? value < *info.max : value <= *info.max);
}

bool isChoice(const std::string& value, const ParameterInfo& info) {
    return info.choices.empty() || std::find(info.choices.begin(), info.choices.end(), value) != info.choices.end();
}

/// "a number, 0 < min_radius <= 100 pixels"
std::string expectation(const ParameterInfo& info) {
    std::string text = info.type == "integer"    ? "an integer"
                       : info.type == "numbers"  ? "an array of numbers"
                       : info.type == "spectrum" ? "a colour (a number, [r,g,b] or {\"type\": \"rgb\", \"value\": …})"
                                                 : "a number";
    if (const std::string range = info.range(); !range.empty()) text += ", " + range;
    return info.unit.empty() ? text : fmt::format("{} {}", text, info.unit);
}

/// Fails where one of the numbers of a parameter is out of its bounds.
void checkRange(const JsonNode& node, double value, const ParameterInfo& info) {
    if (!inRange(value, info)) node.expected(fmt::format("{} for {}", expectation(info), inQuotes(info.name)));
}

/// Reads a value into a member of a parameter struct.
struct Reader {
    const JsonNode& node;
    const ParameterInfo& info;

    void operator()(double* member) const {
        *member = node.number();
        checkRange(node, *member, info);
    }
    void operator()(float* member) const {
        const double value = node.number();
        checkRange(node, value, info);
        if (std::abs(value) > std::numeric_limits<float>::max()) node.expected("a number within single precision");
        *member = static_cast<float>(value);
    }
    template <std::integral T>
    void operator()(T* member) const {
        const auto value = [this] {
            if constexpr (std::is_unsigned_v<T>)
                return node.unsignedInteger();
            else
                return node.integer();
        }();
        checkRange(node, static_cast<double>(value), info);
        using Limits = std::numeric_limits<T>;
        if (value < Limits::min() || value > Limits::max())
            node.expected(fmt::format("an integer from {} to {}", Limits::min(), Limits::max()));
        *member = static_cast<T>(value);
    }
    void operator()(bool* member) const { *member = node.boolean(); }
    void operator()(std::string* member) const {
        *member = node.string();
        if (!isChoice(*member, info))
            node.expected(fmt::format("one of {} for {}", listInQuotes(info.choices), inQuotes(info.name)),
                          didYouMean(*member, info.choices));
    }
    void operator()(std::vector<double>* member) const {
        *member = node.numbers();
        for (std::size_t i = 0; i < member->size(); ++i)
            if (!inRange((*member)[i], info)) checkRange(node[i], (*member)[i], info);
    }
    void operator()(Spectrum* member) const {
        *member = parseSpectrum(node);
        for (const double component : {member->x, member->y, member->z}) checkRange(node, component, info);
    }
    void operator()(Json* member) const { *member = node.json(); }
    void operator()(JsonNode* member) const { *member = node; }
};

ParameterInfo infoOf(const ParameterList::Parameter& parameter) {
    const ParameterNotes& notes = parameter.notes;
    return {parameter.name,
            typeOf(parameter.member),
            valueOf(parameter.member),
            notes.min,
            notes.max,
            notes.minExclusive,
            notes.maxExclusive,
            notes.unit,
            notes.help,
            notes.choices,
            limitOf(parameter.member, false),
            limitOf(parameter.member, true),
            notes.example ? Json::parse(notes.example) : valueOf(parameter.member)};
}

Json schemaOf(const ParameterInfo& info) {
    Json number = {{"type", info.type == "integer" ? "integer" : "number"}};
    if (info.type == "integer") number["minimum"] = info.lowest, number["maximum"] = info.highest;
    if (info.min) number[info.minExclusive ? "exclusiveMinimum" : "minimum"] = *info.min;
    if (info.max) number[info.maxExclusive ? "exclusiveMaximum" : "maximum"] = *info.max;

    Json schema = Json::object();
    if (info.type == "numbers") {
        schema = {{"type", "array"}, {"items", number}};
    } else if (info.type == "spectrum") {
        const Json triple = {{"type", "array"}, {"items", number}, {"minItems", 3}, {"maxItems", 3}};
        const Json plain = Json::array({number, triple});
        const Json rgb = {
            {"type", "object"},
            {"properties",
             {{"type", {{"const", "rgb"}}}, {"value", {{"anyOf", plain}, {"examples", Json::array({info.example})}}}}},
            {"required", Json::array({"type", "value"})},
            {"additionalProperties", false}};
        schema["anyOf"] = Json::array({number, triple, rgb});
    } else if (info.type == "number" || info.type == "integer") {
        schema = number;
    } else if (info.type != "json") {
        schema["type"] = info.type;
        if (!info.choices.empty()) schema["enum"] = info.choices;
    }
    schema["description"] = info.unit.empty() ? info.help : fmt::format("{} [{}]", info.help, info.unit);
    if (!info.defaultValue.is_null()) schema["default"] = info.defaultValue;
    if (!info.example.is_null()) schema["examples"] = Json::array({info.example});
    return schema;
}

}  // namespace

std::string ParameterInfo::range() const {
    if (!choices.empty()) return fmt::format("{}", fmt::join(choices, " | "));
    if (!min && !max) return "";
    const std::string low = min ? fmt::format("{} {} ", *min, minExclusive ? "<" : "<=") : "";
    const std::string high = max ? fmt::format(" {} {}", maxExclusive ? "<" : "<=", *max) : "";
    return low + "x" + high;
}

std::vector<ParameterInfo> ParameterList::info() const {
    std::vector<ParameterInfo> result;
    for (const Parameter& parameter : parameters_) {
        const ParameterInfo info = infoOf(parameter);
        const auto sameName = [&](const ParameterInfo& other) { return other.name == info.name; };
        if (std::any_of(result.begin(), result.end(), sameName))
            fail(ExitCode::InvalidConfig, "parameter {} is described twice", inQuotes(info.name));
        try {
            if (info.type != "json")
                for (const Json& value : {info.example, info.defaultValue})
                    std::visit(Reader{JsonNode(value), info}, parameter.member);
        } catch (const Error& error) {
            fail(ExitCode::InvalidConfig, "the default or example of parameter {} breaks its own description: {}",
                 inQuotes(info.name), error.what());
        }
        result.push_back(info);
    }
    return result;
}

void ParameterList::parse(const JsonNode& object, const std::vector<std::string>& alsoAllowed) const {
    std::vector<std::string> names;
    for (const Parameter& parameter : parameters_) names.push_back(parameter.name);
    names.insert(names.end(), alsoAllowed.begin(), alsoAllowed.end());
    object.allowOnly("parameter", names);
    for (const Parameter& parameter : parameters_)
        if (const auto node = object.find(parameter.name);
            node && std::find(alsoAllowed.begin(), alsoAllowed.end(), parameter.name) == alsoAllowed.end())
            std::visit(Reader{*node, infoOf(parameter)}, parameter.member);
}

Json ParameterList::toJson() const {
    Json result = Json::object();
    for (const Parameter& parameter : parameters_) result[parameter.name] = valueOf(parameter.member);
    return result;
}

Json jsonSchema(const std::vector<ParameterInfo>& parameters) {
    Json properties = Json::object();
    for (const ParameterInfo& info : parameters) properties[info.name] = schemaOf(info);
    return {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
}

Spectrum parseSpectrum(const JsonNode& node) {
    constexpr const char* kForms = "a colour (a number, [r,g,b] or {\"type\": \"rgb\", \"value\": …})";
    if (node.isNumber()) return Spectrum(node.number());
    if (node.isArray()) {
        if (node.size() != 3) node.expected(kForms);
        const std::vector<double> rgb = node.numbers();
        return {rgb[0], rgb[1], rgb[2]};
    }
    const auto type = node.isObject() ? node.find("type") : std::nullopt;
    if (!type || type->json() != "rgb") node.expected(kForms);
    node.allowOnly("key of a colour", {"type", "value"});
    const JsonNode value = node.at("value");
    if (value.isObject()) value.expected("a number or [r,g,b]");
    return parseSpectrum(value);
}

}  // namespace ulam
