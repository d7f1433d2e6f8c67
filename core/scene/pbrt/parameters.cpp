#include "core/scene/pbrt/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/config/suggest.h"

namespace ulam::pbrt {
namespace {

enum class Holds { Numbers, Texts, Flags, NumbersOrTexts };

struct Type {
    std::string_view name;
    Holds holds;
    size_t group;  ///< numbers of one value; 0: any
};

constexpr std::array kTypes{
    Type{"float", Holds::Numbers, 1},          Type{"integer", Holds::Numbers, 1}, Type{"bool", Holds::Flags, 1},
    Type{"string", Holds::Texts, 1},           Type{"texture", Holds::Texts, 1},   Type{"point2", Holds::Numbers, 2},
    Type{"vector2", Holds::Numbers, 2},        Type{"point3", Holds::Numbers, 3},  Type{"vector3", Holds::Numbers, 3},
    Type{"normal", Holds::Numbers, 3},         Type{"rgb", Holds::Numbers, 3},     Type{"blackbody", Holds::Numbers, 1},
    Type{"spectrum", Holds::NumbersOrTexts, 0}};

const Type& typeOf(const Parameter& parameter) {
    std::vector<std::string> names;
    for (const Type& type : kTypes) {
        if (type.name == parameter.type) return type;
        names.emplace_back(type.name);
    }
    unknownName("type of a parameter", parameter.type, names, parameter.place.text());
}

std::vector<std::string> wordsOf(const std::string& text) {
    std::vector<std::string> words;
    for (size_t begin = text.find_first_not_of(" \t"); begin != text.npos;) {
        const size_t end = std::min(text.find_first_of(" \t", begin), text.size());
        words.push_back(text.substr(begin, end - begin));
        begin = text.find_first_not_of(" \t", end);
    }
    return words;
}

void addValue(Tokens& tokens, const Token& token, const Type& type, Parameter& parameter) {
    const bool isText = token.kind == Token::Kind::Text;
    const bool isFlag = token.kind == Token::Kind::Word && (token.text == "true" || token.text == "false");
    const std::string what = fmt::format("the {} {}", parameter.type, inQuotes(parameter.name));
    if (type.holds == Holds::Flags) {
        if (!isFlag) tokens.unexpected(token, fmt::format("true or false, without quotes, for {}", what));
        parameter.flags.push_back(token.text == "true");
    } else if (isText && type.holds != Holds::Numbers) {
        parameter.texts.push_back(tokens.textOf(token));
    } else if (type.holds == Holds::Texts) {
        tokens.unexpected(token, fmt::format("a text in quotes for {}", what));
    } else {
        const double value = tokens.numberOf(token, what);
        if (type.name == "integer" && (value != std::floor(value) || std::abs(value) > 2147483647))
            tokens.unexpected(token, fmt::format("a whole number for {}", what));
        parameter.numbers.push_back(value);
    }
}

Parameter readParameter(Tokens& tokens) {
    const Token declaration = tokens.next();
    Parameter parameter;
    parameter.place = tokens.place(declaration);
    const std::vector<std::string> words = wordsOf(tokens.textOf(declaration));
    if (words.size() != 2) tokens.unexpected(declaration, "a type and a name, such as \"float radius\"");
    parameter.type = words[0];
    parameter.name = words[1];
    const Type& type = typeOf(parameter);
    Token token = tokens.next();
    if (token.kind == Token::Kind::Open) {
        for (token = tokens.next(); token.kind != Token::Kind::Close; token = tokens.next()) {
            if (token.kind == Token::Kind::End || token.kind == Token::Kind::Open)
                tokens.unexpected(token, fmt::format("values of {} and \"]\"", inQuotes(parameter.name)));
            addValue(tokens, token, type, parameter);
        }
    } else {
        if (token.kind == Token::Kind::End || token.kind == Token::Kind::Close)
            tokens.unexpected(token, fmt::format("a value for {}", inQuotes(parameter.name)));
        addValue(tokens, token, type, parameter);
    }
    if (type.group > 1 && parameter.numbers.size() % type.group != 0)
        refuse(parameter.place, fmt::format("{} is of type {}, {} numbers each, but has {}", inQuotes(parameter.name),
                                            type.name, type.group, parameter.numbers.size()));
    if (!parameter.numbers.empty() && !parameter.texts.empty())
        refuse(parameter.place, fmt::format("{} mixes numbers and texts", inQuotes(parameter.name)));
    return parameter;
}

}  // namespace

Parameters Parameters::read(Tokens& tokens, std::string owner, const Place& place) {
    Parameters result;
    result.owner_ = std::move(owner);
    result.place_ = place;
    while (tokens.peek().kind == Token::Kind::Text) {
        Parameter parameter = readParameter(tokens);
        for (const Parameter& other : result.all_)
            if (other.name == parameter.name)
                refuse(parameter.place, fmt::format("{} is given twice", inQuotes(parameter.name)));
        result.all_.push_back(std::move(parameter));
    }
    return result;
}

void Parameters::addDefaults(const std::vector<Parameter>& defaults) {
    for (const Parameter& parameter : defaults) {
        const auto same = [&](const Parameter& own) { return own.name == parameter.name; };
        if (std::any_of(all_.begin(), all_.end(), same)) continue;
        all_.push_back(parameter);
        all_.back().isDefault = true;
    }
}

void Parameters::note(std::string_view name) const {
    if (std::find(asked_.begin(), asked_.end(), name) == asked_.end()) asked_.emplace_back(name);
}

const Parameter* Parameters::find(std::string_view name, std::initializer_list<std::string_view> types) const {
    note(name);
    for (const Parameter& parameter : all_) {
        if (parameter.name != name) continue;
        if (std::find(types.begin(), types.end(), parameter.type) != types.end()) return &parameter;
        std::string expected;
        for (const std::string_view type : types) expected += (expected.empty() ? "" : " or ") + std::string(type);
        refuse(parameter.place,
               fmt::format("{} of {} is of type {}, found {}", inQuotes(name), owner_, expected, parameter.type));
    }
    return nullptr;
}

const Parameter& Parameters::needed(std::string_view name, std::initializer_list<std::string_view> types) const {
    const Parameter* parameter = find(name, types);
    if (!parameter) refuse(place_, fmt::format("{} has no {}", owner_, inQuotes(name)));
    return *parameter;
}

const Parameter* Parameters::single(std::string_view name, std::string_view type) const {
    const Parameter* parameter = find(name, {type});
    if (parameter && std::max({parameter->numbers.size() / typeOf(*parameter).group, parameter->texts.size(),
                               parameter->flags.size()}) != 1)
        refuse(parameter->place, fmt::format("{} of {} is one value", inQuotes(name), owner_));
    return parameter;
}

double Parameters::number(std::string_view name, double otherwise) const {
    const Parameter* parameter = single(name, "float");
    return parameter ? parameter->numbers[0] : otherwise;
}

int Parameters::integer(std::string_view name, int otherwise) const {
    const Parameter* parameter = single(name, "integer");
    return parameter ? int(parameter->numbers[0]) : otherwise;
}

bool Parameters::flag(std::string_view name, bool otherwise) const {
    const Parameter* parameter = single(name, "bool");
    return parameter ? parameter->flags[0] : otherwise;
}

std::string Parameters::text(std::string_view name, const std::string& otherwise) const {
    const Parameter* parameter = single(name, "string");
    return parameter ? parameter->texts[0] : otherwise;
}

Vec3d Parameters::point(std::string_view name, const Vec3d& otherwise) const {
    const Parameter* parameter = single(name, "point3");
    return parameter ? Vec3d(parameter->numbers[0], parameter->numbers[1], parameter->numbers[2]) : otherwise;
}

void Parameters::ignore(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) note(name);
}

void Parameters::finish() const {
    for (const Parameter& parameter : all_)
        if (!parameter.isDefault && std::find(asked_.begin(), asked_.end(), parameter.name) == asked_.end())
            unknownName("parameter of " + owner_, parameter.name, asked_, parameter.place.text());
}

}  // namespace ulam::pbrt
