#pragma once
// Parameters are described once, beside their defaults:
//
//     struct LensParameters {
//         double minRadius = 0.1;
//         std::string heuristic = "balance";
//         template <class V> void describe(V& v) {
//             v("min_radius", minRadius, {.help = "smallest jump on the film", .unit = "pixels", .min = 0});
//             v("heuristic", heuristic, {.help = "how techniques are weighted", .choices = {"balance", "power"}});
//         }
//     };
//
// From that come parsing, error messages, lists of parameters, JSON Schema and the resolved configuration.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/vector.h"
#include "core/config/json.h"

namespace ulam {

/// What a description says beside name, member and default. Bounds hold for every number of an array or colour.
struct ParameterNotes {
    std::string help = {};
    std::string unit = {};
    std::optional<double> min = {};
    std::optional<double> max = {};
    bool minExclusive = false;
    bool maxExclusive = false;
    std::vector<std::string> choices = {};  // of a string; empty: any
    const char* example = nullptr;          // JSON text, where the default is none or says little
};

/// One parameter as users see it.
struct ParameterInfo {
    std::string name;
    std::string type;  // number, integer, boolean, string, numbers, spectrum, json
    Json defaultValue;
    std::optional<double> min;
    std::optional<double> max;
    bool minExclusive = false;
    bool maxExclusive = false;
    std::string unit;
    std::string help;
    std::vector<std::string> choices;
    Json lowest, highest;  ///< that the type of an integer holds
    Json example;          ///< a value that can be written: the default where nothing else is said; null: none

    /// "0 < x <= 1000000", "balance | power"; empty where anything goes.
    std::string range() const;
};

/// The types a parameter may have. A Json is taken as it is; a JsonNode too, and it keeps its place in the file, so
/// that whoever reads it later can name it in messages.
using ParameterMember = std::variant<double*, float*, int*, std::int64_t*, std::uint32_t*, std::uint64_t*, bool*,
                                     std::string*, std::vector<double>*, Spectrum*, Json*, JsonNode*>;

/// What `describe` is called with: a list of the members of one struct.
class ParameterList {
public:
    struct Parameter {
        std::string name;
        ParameterMember member;
        ParameterNotes notes;
    };

    template <class T>
    void operator()(std::string name, T& member, ParameterNotes notes) {
        parameters_.push_back({std::move(name), ParameterMember(&member), std::move(notes)});
    }

    const std::vector<Parameter>& parameters() const { return parameters_; }

    /// Fails with InvalidConfig where a name is described twice or a default breaks its own bounds or choices.
    std::vector<ParameterInfo> info() const;
    /// Writes the members found in `object`, the others keep their values; so do those whose names are in `alsoAllowed`,
    /// which belong to somebody else.
    void parse(const JsonNode& object, const std::vector<std::string>& alsoAllowed) const;
    Json toJson() const;

private:
    std::vector<Parameter> parameters_;
};

/// A parameter struct: default constructible, copyable, with `describe`.
template <class P>
concept Described = requires(P parameters, ParameterList list) {
    parameters.describe(list);
};

/// Names, types, defaults and bounds of a parameter struct.
template <Described P>
std::vector<ParameterInfo> parameterInfo() {
    P parameters;
    ParameterList list;
    parameters.describe(list);
    return list.info();
}

/// Reads an object. Unknown keys, wrong types and values out of bounds fail with InvalidConfig. `alsoAllowed` names the
/// keys that belong to somebody else.
template <Described P>
P parseParameters(const JsonNode& object, const std::vector<std::string>& alsoAllowed = {"type"}) {
    P parameters;
    ParameterList list;
    parameters.describe(list);
    list.parse(object, alsoAllowed);
    return parameters;
}

/// Every parameter with its value; parseParameters reads it back.
template <Described P>
Json toJson(P parameters) {
    ParameterList list;
    parameters.describe(list);
    return list.toJson();
}

/// A JSON Schema (draft 7) of an object with these members and no others.
Json jsonSchema(const std::vector<ParameterInfo>& parameters);

/// A colour: a number (grey), [r,g,b], or {"type": "rgb", "value": either}.
Spectrum parseSpectrum(const JsonNode& node);

}  // namespace ulam
