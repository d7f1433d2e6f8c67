#pragma once
// Things made by name (mutations, samplers, …). A file registers what it defines with one line at its end,
//
//     ULAM_REGISTER(Mutation, LensPerturbation, "lens", "moves the point on the film");
//
// and a shared library opened at run time does the same: the registry is one object per interface in the whole process.
// The interface names its kind for messages: `static const char* kind()` returns e.g. "mutation". Where objects hold
// keys that all of the kind share (the weight of a mutation), it also has `static std::vector<std::string>
// commonKeys()`.

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/config/json.h"
#include "core/config/parameters.h"
#include "core/config/suggest.h"

namespace ulam {

template <class Interface>
class Registry {
public:
    struct Entry {
        std::string name;
        std::string summary;
        std::string file;  // base name of the source file
        std::vector<ParameterInfo> parameters;
        std::function<std::unique_ptr<Interface>(const JsonNode&)> create;
        std::function<Json(const JsonNode&)> resolve;  // every parameter with its value
    };

    /// One object for the program, which exports its symbols, and every library it opens; these must not be compiled
    /// with hidden visibility.
    static Registry& instance() {
        static Registry registry;
        return registry;
    }

    /// Fails with InvalidConfig, naming both files, where the name is taken.
    void add(Entry entry) {
        const auto place = std::lower_bound(entries_.begin(), entries_.end(), entry.name,
                                            [](const auto& e, const std::string& name) { return e->name < name; });
        if (place != entries_.end() && (*place)->name == entry.name)
            fail(ExitCode::InvalidConfig, "{} {} is registered twice, in {} and in {}", Interface::kind(),
                 inQuotes(entry.name), (*place)->file, entry.file);
        entries_.insert(place, std::make_unique<Entry>(std::move(entry)));
    }

    /// Keeps an error of registration until the first use: thrown before main or while a library is being opened it
    /// would end the program without a message.
    void addProblem(std::string message) { problems_.push_back(std::move(message)); }

    /// Fails with InvalidConfig where there is no such name, with the place and the nearest one.
    const Entry& find(std::string_view name, const JsonNode& where) const {
        for (const Entry* entry : entries())
            if (entry->name == name) return *entry;
        unknownName(Interface::kind(), name, names(), where.where());
    }

    /// Sorted by name.
    std::vector<const Entry*> entries() const {
        if (!problems_.empty()) fail(ExitCode::InvalidConfig, "{}", problems_.front());
        std::vector<const Entry*> result;
        for (const auto& entry : entries_) result.push_back(entry.get());
        return result;
    }

    bool contains(std::string_view name) const {
        return std::ranges::any_of(entries(), [&](const Entry* entry) { return entry->name == name; });
    }

    /// Sorted.
    std::vector<std::string> names() const {
        std::vector<std::string> result;
        for (const Entry* entry : entries()) result.push_back(entry->name);
        return result;
    }

    /// From {"type": name, parameters…}.
    std::unique_ptr<Interface> create(const JsonNode& object) const {
        const JsonNode type = object.at("type");
        return find(type.string(), type).create(object);
    }

private:
    std::vector<std::unique_ptr<Entry>> entries_;
    std::vector<std::string> problems_;
};

/// The registration of T, which has a nested `struct Parameters` with describe() (see parameters.h) and a constructor
/// `explicit T(const Parameters&)`.
template <class Interface, class T>
struct Registration {
    Registration(const char* name, const char* summary, const char* file) {
        using Parameters = typename T::Parameters;
        auto& registry = Registry<Interface>::instance();
        const std::string path = file;
        const std::string base = path.substr(path.find_last_of('/') + 1);
        try {
            registry.add(
                {name, summary, base, parameterInfo<Parameters>(),
                 [](const JsonNode& node) -> std::unique_ptr<Interface> {
                     return std::make_unique<T>(parseParameters<Parameters>(node, commonKeys()));
                 },
                 [](const JsonNode& node) { return toJson(parseParameters<Parameters>(node, commonKeys())); }});
        } catch (const std::exception& error) {
            registry.addProblem(fmt::format("{}: {}", base, error.what()));
        }
    }

private:
    static std::vector<std::string> commonKeys() {
        std::vector<std::string> keys = {"type"};
        if constexpr (requires { Interface::commonKeys(); })
            for (auto& key : Interface::commonKeys()) keys.push_back(key);
        return keys;
    }
};

#define ULAM_JOIN_AGAIN(a, b) a##b
#define ULAM_JOIN(a, b) ULAM_JOIN_AGAIN(a, b)
/// Registers a class under a name, with one line of help; stands at the end of the file that defines it.
#define ULAM_REGISTER(Interface, Type, name, summary)                                                             \
    [[maybe_unused]] static const ::ulam::Registration<Interface, Type> ULAM_JOIN(ulamRegistration, __COUNTER__)( \
        name, summary, __FILE__)

}  // namespace ulam
