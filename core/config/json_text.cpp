#include "core/config/json_text.h"

#include <algorithm>
#include <unordered_map>

#include "core/base/error.h"
#include "core/config/suggest.h"

namespace ulam {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Builds the value from the parser's events. The cursor follows the parser token by token, which gives positions.
class Builder : public nlohmann::json_sax<Json> {
public:
    Builder(std::string_view text, std::string_view name) : text_(text), name_(name), cursor_(text) {}

    Json take() { return std::move(root_); }

    bool null() override { return scalar(nullptr); }
    bool boolean(bool value) override { return scalar(value); }
    bool number_integer(number_integer_t value) override { return scalar(value); }
    bool number_unsigned(number_unsigned_t value) override { return scalar(value); }
    bool number_float(number_float_t value, const string_t&) override { return scalar(value); }
    bool string(string_t& value) override { return scalar(std::move(value)); }
    bool binary(binary_t&) override { return false; }

    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& key) override {
        const std::size_t offset = cursor_.next();
        Container& object = open_.back();
        const auto [first, isNew] = object.keys.emplace(key, offset);
        if (!isNew) {
            const TextPosition before = positionAt(text_, first->second);
            fail(ExitCode::InvalidConfig, "key {} stands twice in one object, at {} and before at {}:{}", inQuotes(key),
                 placeOf(name_, text_, offset), before.line, before.column);
        }
        object.key = std::move(key);
        return true;
    }

    bool parse_error(std::size_t position, const std::string&, const Json::exception& error) override {
        // "[json.exception.…] parse error at line 1, column 2: what is wrong": the place is said in our way.
        std::string message = error.what();
        if (message.starts_with('[')) message.erase(0, std::min(message.size(), message.find(']') + 2));
        if (message.starts_with("parse error at")) message.erase(0, message.find(": ") + 2);
        fail(ExitCode::InvalidConfig, "{}: {}", placeOf(name_, text_, position == 0 ? 0 : position - 1),
             printable(message, 300));
    }

private:
    struct Container {
        Json value;
        std::string key;  // of the member being read
        std::unordered_map<std::string, std::size_t> keys;
    };

    bool scalar(Json value) {
        cursor_.next();
        return put(std::move(value));
    }

    bool open(Json empty) {
        const std::size_t offset = cursor_.next();
        if (open_.size() == kMaxJsonDepth)
            fail(ExitCode::InvalidConfig, "{}: objects and arrays are nested deeper than {} levels",
                 placeOf(name_, text_, offset), kMaxJsonDepth);
        open_.push_back({std::move(empty), {}, {}});
        return true;
    }

    bool close() {
        cursor_.next();
        Json value = std::move(open_.back().value);
        open_.pop_back();
        return put(std::move(value));
    }

    bool put(Json value) {
        if (open_.empty()) {
            root_ = std::move(value);
        } else if (Container& parent = open_.back(); parent.value.is_array()) {
            parent.value.get_ref<Json::array_t&>().push_back(std::move(value));
        } else {
            // The keys are known to differ; ordered_map would compare with every one again.
            std::vector<Json::object_t::value_type>& members = parent.value.get_ref<Json::object_t&>();
            members.emplace_back(std::move(parent.key), std::move(value));
        }
        return true;
    }

    std::string_view text_;
    std::string_view name_;
    TokenCursor cursor_;
    std::vector<Container> open_;
    Json root_;
};

bool isBlank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

}  // namespace

TokenCursor::TokenCursor(std::string_view text) : text_(text) {
    if (text_.starts_with(kByteOrderMark)) end_ = kByteOrderMark.size();
}

void TokenCursor::skipSeparators() {
    while (end_ < text_.size()) {
        if (isBlank(text_[end_]) || text_[end_] == ',' || text_[end_] == ':')
            ++end_;
        else if (text_.substr(end_, 2) == "//")
            end_ = std::min(text_.find_first_of("\n\r", end_), text_.size());
        else if (text_.substr(end_, 2) == "/*")
            end_ = std::min(text_.find("*/", end_ + 2), text_.size() - 2) + 2;
        else
            return;
    }
}

std::size_t TokenCursor::next() {
    skipSeparators();
    const std::size_t start = end_;
    if (start >= text_.size()) return text_.size();
    if (text_[start] == '"') {
        for (++end_; end_ < text_.size() && text_[end_] != '"'; ++end_)
            if (text_[end_] == '\\') ++end_;
        end_ = std::min(end_ + 1, text_.size());
    } else if (std::string_view("{}[]").find(text_[start]) != std::string_view::npos) {
        ++end_;
    } else {
        end_ = std::min(text_.find_first_of(" \t\n\r,:/{}[]\"", start), text_.size());
    }
    return start;
}

std::optional<std::size_t> locate(std::string_view text, const std::vector<std::string>& steps) {
    TokenCursor cursor(text);
    const auto charAt = [text](std::size_t offset) { return offset < text.size() ? text[offset] : '\0'; };
    const auto skipValueAt = [&](std::size_t start) {
        for (int depth = 0;; start = cursor.next()) {
            const char c = charAt(start);
            if (c == '{' || c == '[') ++depth;
            if (c == '}' || c == ']') --depth;
            if (depth == 0 || c == '\0') return;
        }
    };
    std::size_t start = cursor.next();
    for (const std::string& step : steps) {
        const bool isObject = charAt(start) == '{';
        if (!isObject && charAt(start) != '[') return {};
        for (std::size_t index = 0;; ++index) {
            start = cursor.next();
            if (const char c = charAt(start); c == '}' || c == ']' || c == '\0') return {};
            std::string name = std::to_string(index);
            if (isObject) {
                name = Json::parse(text.substr(start, cursor.end() - start)).get<std::string>();
                start = cursor.next();
            }
            if (name == step) break;
            skipValueAt(start);
        }
    }
    return start;
}

TextPosition positionAt(std::string_view text, std::size_t offset) {
    const std::string_view before = text.substr(0, std::min(offset, text.size()));
    const std::size_t newline = before.rfind('\n');
    std::string_view line = before.substr(newline == std::string_view::npos ? 0 : newline + 1);
    if (newline == std::string_view::npos && line.starts_with(kByteOrderMark))
        line.remove_prefix(kByteOrderMark.size());
    const auto startsCharacter = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
    return {1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')),
            1 + static_cast<std::size_t>(std::count_if(line.begin(), line.end(), startsCharacter))};
}

std::string placeOf(std::string_view name, std::string_view text, std::size_t offset) {
    const TextPosition position = positionAt(text, offset);
    return fmt::format("{}:{}:{}", name, position.line, position.column);
}

Json parseJson(std::string_view text, std::string_view name) {
    // The parser would take a zero byte for the end of the text.
    if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos)
        fail(ExitCode::InvalidConfig, "{}: expected UTF-8 text, found a zero byte", placeOf(name, text, zero));
    Builder builder(text, name);
    const bool strict = true, ignoreComments = true;
    Json::sax_parse(text.begin(), text.end(), &builder, Json::input_format_t::json, strict, ignoreComments);
    return builder.take();
}

std::string escapePointerStep(std::string_view step) {
    std::string result;
    for (const char c : step) {
        if (c == '~')
            result += "~0";
        else if (c == '/')
            result += "~1";
        else
            result += c;
    }
    return result;
}

std::vector<std::string> pointerSteps(std::string_view pointer) {
    std::vector<std::string> steps;
    for (std::size_t i = 0; i < pointer.size(); ++i) {
        if (pointer[i] == '/')
            steps.emplace_back();
        else if (!steps.empty() && pointer[i] == '~' && i + 1 < pointer.size())
            steps.back() += pointer[++i] == '1' ? '/' : '~';
        else if (!steps.empty())
            steps.back() += pointer[i];
    }
    return steps;
}

}  // namespace ulam
