#pragma once
// JSON as users write it: comments allowed, mistakes refused, and every value knows where it stands in its file.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ulam {

/// Keeps the order in which members were written.
using Json = nlohmann::ordered_json;

/// Deepest nesting of objects and arrays that is read.
inline constexpr int kMaxJsonDepth = 128;
/// Largest text that is read, in bytes.
inline constexpr std::size_t kMaxJsonBytes = std::size_t{256} << 20;

/// Both count from 1; columns count characters, not bytes.
struct TextPosition {
    std::size_t line = 1;
    std::size_t column = 1;
};

struct JsonSource;

/// One value inside a document: the value, its JSON pointer (RFC 6901) and the text it came from. Copies are cheap and
/// share the document, so a node never dangles. All errors are ExitCode::InvalidConfig and say what was expected, what
/// was found and where.
class JsonNode {
public:
    /// A value made in memory: it has a pointer, but no position.
    explicit JsonNode(Json value = nullptr);
    JsonNode(std::shared_ptr<const Json> value, std::shared_ptr<const JsonSource> source, std::string pointer);

    const Json& json() const { return *value_; }
    const std::string& pointer() const { return pointer_; }
    /// The last step of the pointer: the name or index under which the value stands; empty for the root.
    std::string key() const;
    /// "scene.json:12:7 (/sensor/fov)". Scans the text again, so it is meant for messages only.
    std::string where() const;

    bool isNull() const { return value_->is_null(); }
    bool isObject() const { return value_->is_object(); }
    bool isArray() const { return value_->is_array(); }
    bool isString() const { return value_->is_string(); }
    bool isNumber() const { return value_->is_number(); }
    bool isBoolean() const { return value_->is_boolean(); }

    /// Finite.
    double number() const;
    /// Whole numbers; 1e6 is one.
    std::int64_t integer() const;
    std::uint64_t unsignedInteger() const;
    bool boolean() const;
    const std::string& string() const;
    /// An array of finite numbers.
    std::vector<double> numbers() const;
    std::vector<double> numbers(std::size_t count) const;

    /// The member of an object; `at` fails where it is missing.
    JsonNode at(std::string_view key) const;
    std::optional<JsonNode> find(std::string_view key) const;
    /// The element of an array.
    JsonNode operator[](std::size_t index) const;
    /// Members of an object or elements of an array.
    std::size_t size() const;
    std::vector<std::pair<std::string, JsonNode>> members() const;
    std::vector<JsonNode> elements() const;
    /// Fails at the first member of the object whose name is not allowed; `kind` says what the names are ("parameter").
    void allowOnly(std::string_view kind, const std::vector<std::string>& allowed) const;

    /// "<message> at <where>; <hint>"
    [[noreturn]] void fail(std::string_view message, std::string_view hint = {}) const;
    /// "expected <what>, found <value> at <where>; <hint>"
    [[noreturn]] void expected(std::string_view what, std::string_view hint = {}) const;

private:
    JsonNode child(const Json& value, std::string_view key) const;

    std::shared_ptr<const Json> value_;
    std::shared_ptr<const JsonSource> source_;
    std::string pointer_;
};

/// A JSON text and its value. Refused with the position: duplicate keys, nesting beyond kMaxJsonDepth, numbers beyond
/// double, NaN and Infinity, invalid UTF-8, texts beyond kMaxJsonBytes. Comments (// and /* */) are allowed.
class JsonDocument {
public:
    /// `name` stands for the file in messages.
    static JsonDocument fromText(std::string text, std::string name);
    /// A value read from a text that is not JSON. `places`: JSON pointers and what messages say of them
    /// ("scene.xml:3:5"); of those that cover a value the last one counts.
    static JsonDocument fromParts(Json value, std::string name, std::vector<std::pair<std::string, std::string>> places);
    /// Fails with InputMissing where the file cannot be read.
    static JsonDocument fromFile(const std::filesystem::path& path);

    const std::string& name() const;
    const Json& json() const { return *value_; }
    JsonNode root() const { return JsonNode(value_, source_, ""); }
    /// Where the value at a JSON pointer stands in the text; none for what was not written there.
    std::optional<TextPosition> position(std::string_view pointer) const;

    /// Changes the value at a path such as "samplers.mlt.chains" (see setValueByPath). From then on messages about it
    /// name `origin` ("--set samplers.mlt.chains=0") in place of a line. Nodes handed out before keep the old value.
    void set(std::string_view path, Json value, std::string origin);
    /// Every "a.b=value" of `--set` (see applyOverrides).
    void applyOverrides(const std::vector<std::string>& assignments);

private:
    JsonDocument(std::shared_ptr<const Json> value, std::shared_ptr<const JsonSource> source);

    std::shared_ptr<const Json> value_;
    std::shared_ptr<const JsonSource> source_;
};

/// The steps of a path such as "samplers.mlt.chains"; fails with InvalidConfig where one is empty.
std::vector<std::string> pathSteps(std::string_view path);
/// Sets the value at a path of names and array indices joined by dots. Missing objects on the way are made; an index
/// must exist; a step into anything else fails with InvalidConfig.
void setValueByPath(Json& root, std::string_view path, Json value);
/// The same with a value as typed on a command line (see overrideValue).
void setByPath(Json& root, std::string_view path, std::string_view text);
/// The JSON in `text`, or `text` as a string where it is none; broken arrays, objects and quoted strings fail.
Json overrideValue(std::string_view text);
/// Splits "a.b=value" into path and value; fails with Usage where there is no path or no "=".
std::pair<std::string, std::string> splitAssignment(std::string_view assignment);
void applyOverrides(Json& root, const std::vector<std::string>& assignments);

/// Whether a text can be a string of JSON.
bool isUtf8(std::string_view text);

/// Indented by two spaces. Fails with CannotWrite, naming the pointer, at a number that is not finite (JSON has none),
/// and at a string that is not UTF-8.
std::string dump(const Json& value);

}  // namespace ulam
