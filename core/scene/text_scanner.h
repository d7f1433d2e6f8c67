#pragma once
// Lines, words and numbers of a text, for readers of mesh files.

#include <charconv>
#include <optional>
#include <string_view>

namespace ulam {

inline bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
inline bool isBlankOrLineEnd(char c) { return isBlank(c) || c == '\n'; }

/// The next word of a line, which is taken off it; empty at the end.
inline std::string_view nextWord(std::string_view& line, bool (*isSeparator)(char) = isBlank) {
    size_t first = 0;
    while (first < line.size() && isSeparator(line[first])) ++first;
    size_t end = first;
    while (end < line.size() && !isSeparator(line[end])) ++end;
    const std::string_view word = line.substr(first, end - first);
    line.remove_prefix(end);
    return word;
}

/// The next line, which is taken off the text together with its end.
inline std::string_view nextLine(std::string_view& text) {
    const size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return line;
}

/// The number that a whole word is; nothing for any other word.
template <class Number>
std::optional<Number> toNumber(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

}  // namespace ulam
