#pragma once
// Lines, words and numbers of a text, for readers of mesh files.

#include <charconv>
#include <optional>
#include <string_view>

namespace ulam {

/// The next word of a line, which is taken off it; empty at the end. Separators are blanks.
inline std::string_view nextWord(std::string_view& line, std::string_view separators = " \t\r") {
    const size_t first = line.find_first_not_of(separators);
    line.remove_prefix(first == std::string_view::npos ? line.size() : first);
    const std::string_view word = line.substr(0, line.find_first_of(separators));
    line.remove_prefix(word.size());
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
