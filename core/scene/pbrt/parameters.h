#pragma once
// Lists of parameters: "float radius" 2 "rgb L" [1 2 3].

#include <initializer_list>

#include "core/base/vector.h"
#include "core/scene/pbrt/tokens.h"

namespace ulam::pbrt {

struct Parameter {
    std::string type, name;
    Place place;
    std::vector<double> numbers;
    std::vector<std::string> texts;
    std::vector<bool> flags;
    bool isDefault = false;  ///< from an Attribute directive: nobody need ask for it
};

/// What follows a plugin's name. Readers ask for what they know; `finish` refuses what nobody asked for.
class Parameters {
public:
    /// Up to the next directive. `owner` is for messages: `shape "sphere"`.
    static Parameters read(Tokens& tokens, std::string owner, const Place& place);
    Parameters() = default;

    /// Those of Attribute directives, for names that are not given here.
    void addDefaults(const std::vector<Parameter>& defaults);
    const std::vector<Parameter>& all() const { return all_; }
    const std::string& owner() const { return owner_; }
    const Place& place() const { return place_; }

    /// Null where it is not given; refused where it is of another type.
    const Parameter* find(std::string_view name, std::initializer_list<std::string_view> types) const;
    double number(std::string_view name, double otherwise) const;
    int integer(std::string_view name, int otherwise) const;
    bool flag(std::string_view name, bool otherwise) const;
    std::string text(std::string_view name, const std::string& otherwise) const;
    Vec3d point(std::string_view name, const Vec3d& otherwise) const;
    /// Fails where it is missing.
    const Parameter& needed(std::string_view name, std::initializer_list<std::string_view> types) const;

    /// Parameters that have no meaning here.
    void ignore(std::initializer_list<std::string_view> names) const;
    void finish() const;

private:
    const Parameter* single(std::string_view name, std::string_view type) const;
    void note(std::string_view name) const;

    std::string owner_;
    Place place_;
    std::vector<Parameter> all_;
    mutable std::vector<std::string> asked_;
};

}  // namespace ulam::pbrt
